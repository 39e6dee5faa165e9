"""Films of recordings: decoded again, they have the frames, the size and the times of the recording."""

from __future__ import annotations

import io
import json
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import av
import numpy as np
import pytest
from golden import same
from PIL import Image
from written_recordings import BEGAN_NS, write_lesson

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.cli import app
from beatrix_zenoh.recording.film import EMPTY, EYE, PANEL, Pixels, PoseRenderer
from beatrix_zenoh.recording.rows import Frame, of_robot
from beatrix_zenoh.recording.rrd.read import read

SIM, HW = ("ada", "sim"), ("ada", "hw")
TIMES_MS = (0, 210, 400, 1450, 1500)
"""Times of the pictures: as irregular as those of a camera."""
COLOURS = ((200, 30, 30), (30, 200, 30), (30, 30, 200), (200, 200, 30), (30, 200, 200))


@dataclass(frozen=True)
class Decoded:
    """A film that was read again."""

    codec: str
    form: str
    colours: tuple[int, int]
    times_s: list[float]
    pictures: list[Pixels]


def decoded(path: Path) -> Decoded:
    with av.open(str(path)) as container:
        (stream,) = container.streams.video
        assert stream.time_base is not None
        frames = list(container.decode(stream))
        return Decoded(
            stream.codec_context.name,
            str(stream.codec_context.pix_fmt),
            (int(stream.codec_context.colorspace), int(stream.codec_context.color_range)),
            [float(frame.pts * stream.time_base) for frame in frames if frame.pts is not None],
            [frame.to_ndarray(format="rgb24").astype(np.uint8) for frame in frames],
        )


def jpeg(colour: tuple[int, int, int], size: tuple[int, int] = (64, 48)) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", size, colour).save(file, "JPEG")
    return file.getvalue()


def eye(place: tuple[str, str], which: str, pictures: Sequence[bytes] = ()) -> list[Frame]:
    """Return the rows of an eye's pictures at TIMES_MS."""
    path = of_robot(place, "camera", which)
    return [
        Frame(path, BEGAN_NS + ms * 1_000_000, BEGAN_NS, picture)
        for ms, picture in zip(TIMES_MS, pictures or map(jpeg, COLOURS), strict=True)
    ]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of 2 s of both robots, of which the simulation has an eye."""
    path = tmp_path_factory.mktemp("film") / "lesson.rrd"
    write_lesson(path, (SIM, HW), rows=101, more=eye(SIM, "left"))
    return path


@pytest.fixture
def folder(written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with only that recording."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(written, tmp_path)
    return tmp_path


def test_both_robots_stand_beside_each_other(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["export", "lesson.rrd", "lesson.csv", "--video", "both.mp4", "--to", "0.44", "--json"]
    assert app.run(words) == 0
    assert json.loads(capsys.readouterr().out) == {
        "result": True, "robots": ["ada (hw)", "ada (sim)"], "file": "lesson.csv", "rows": 23, "video": "both.mp4",
        "frames": 12, "left_out": 0,
    }  # fmt: skip
    film = decoded(folder / "both.mp4")
    assert film.times_s == pytest.approx([k / 25 for k in range(12)], abs=1 / 45_000)
    last = film.pictures[-1]
    assert last.shape == (PANEL[1] + EYE[1], 2 * PANEL[0], 3)
    samples = read(folder / "lesson.rrd").robots[SIM]
    wanted = PoseRenderer(Figure(), *PANEL).picture(samples.arms[22], samples.head[22])
    for column in (0, PANEL[0]):
        shown = last[60 : PANEL[1], column : column + PANEL[0]]
        assert np.abs(shown.astype(int) - wanted[60:]).mean() < 3
    left, right = last[PANEL[1] + 40, 40], last[PANEL[1] + 40, EYE[0] + 40]
    assert np.abs(left.astype(int) - COLOURS[2]).max() < 12, "the newest picture"
    assert np.abs(right.astype(int) - EMPTY).max() < 12


def test_a_film_says_how_many_pictures_it_leaves_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = [jpeg(colour) for colour in COLOURS]
    path = tmp_path / "lesson.rrd"
    write_lesson(path, (SIM, HW), rows=101, more=eye(SIM, "left", [whole[0], whole[1][:50], *whole[2:]]))
    assert app.run(["export", str(path), "--video", str(tmp_path / "eye.mp4"), "--eye", "left"]) == 0
    assert f"{len(COLOURS) - 1} frames" in (printed := capsys.readouterr().out)
    assert printed.endswith(" 1 damaged or repeated pictures are left out.\n")


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--video", "new.avi"], 2, "must end in .mp4"),
        (["--eye", "left"], 2, "give --video FILE.mp4, too"),
        (
            ["--video", "new.mp4", "--on", "hw"],
            2,
            "give --eye left or --eye right, too. Without --eye the film shows",
        ),
        (["--video", "new.mp4", "--eye", "left", "--on", "both"], 2, "Give sim or hw"),
        (["--video", "new.mp4", "--eye", "right"], 1, "it has pictures of: left (ada, sim)"),
        (["--video", "new.mp4", "--eye", "left", "--from", "1.6"], 1, "it has pictures of: none"),
        (["--video", "new.mp4", "--samples"], 2, "--samples needs a table"),
        (["--video", "kept.mp4"], 1, "kept.mp4 exists and is not overwritten"),
        (["--video", "missing/new.mp4", "--to", "0.1"], 1, "cannot be written: No such file"),
    ],
)
def test_refusals_name_the_cure_and_write_nothing(
    folder: Path, words: list[str], code: int, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("kept.mp4").write_text("mine")
    assert app.run(["export", "lesson.rrd", *words]) == code
    assert says in " ".join(capsys.readouterr().err.split())
    assert sorted(path.name for path in folder.iterdir()) == ["kept.mp4", "lesson.rrd"]


def test_the_robot_of_a_film_is_chosen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    both = tmp_path / "both.rrd"
    write_lesson(both, (SIM, ("bob", "sim")), more=[*eye(SIM, "left"), *eye(("bob", "sim"), "left")])
    assert app.run(["export", str(both), "--video", str(tmp_path / "new.mp4")]) == 1
    same("film.the robot of a film is chosen 1", capsys.readouterr().err)
    sides = tmp_path / "twins.rrd"
    write_lesson(sides, (SIM, HW), more=[*eye(SIM, "left"), *eye(HW, "left")])
    assert app.run(["export", str(sides), "--video", str(tmp_path / "new.mp4"), "--eye", "left"]) == 1
    same("film.the robot of a film is chosen 2", capsys.readouterr().err)


def test_the_sentence_for_a_missing_library_contains_the_command(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "beatrix_zenoh.recording.film", None)
    assert app.run(["export", "lesson.rrd", "--video", "new.mp4"]) == 1
    assert 'pip install ".[video]"' in capsys.readouterr().err
    assert not (folder / "new.mp4").exists()
