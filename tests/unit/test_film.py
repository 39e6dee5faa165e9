"""Films of recordings: decoded again, they have the frames, the size and the times of the recording."""

from __future__ import annotations

import io
import json
import wave
from collections.abc import Sequence
from pathlib import Path

import av
import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image
from written_recordings import BEGAN_NS, STEP_NS, write_lesson

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.portrait import Pixels, PoseRenderer
from beatrix_zenoh.cli import app
from beatrix_zenoh.client.sound import Sound
from beatrix_zenoh.recording.film import PANEL
from beatrix_zenoh.recording.rows import Frame, Numbers, RecordingRow, SoundRow, of_robot
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.sound import rows_of

SIM, HW = ("ada", "sim"), ("ada", "hw")
TIMES_MS = (0, 210, 400, 1450, 1500)
"""Times of the pictures: as irregular as those of a camera."""
COLOURS = ((200, 30, 30), (30, 200, 30), (30, 30, 200), (200, 200, 30), (30, 200, 200))


def decoded(path: Path) -> tuple[list[float], list[Pixels]]:
    """Return the times (s) and the pictures of a film."""
    with av.open(str(path)) as container:
        (stream,) = container.streams.video
        assert stream.time_base is not None
        frames = list(container.decode(stream))
        times_s = [float(frame.pts * stream.time_base) for frame in frames if frame.pts is not None]
        return times_s, [frame.to_ndarray(format="rgb24").astype(np.uint8) for frame in frames]


def jpeg(colour: tuple[int, int, int], size: tuple[int, int] = (64, 48)) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", size, colour).save(file, "JPEG")
    return file.getvalue()


def eye(place: tuple[str, str], which: str, pictures: Sequence[bytes] = ()) -> list[Frame]:
    """Return the rows of an eye's pictures at TIMES_MS."""
    path = of_robot(place, "camera", which)
    return [
        Frame(path, BEGAN_NS + ms * 1_000_000, picture)
        for ms, picture in zip(TIMES_MS, pictures or map(jpeg, COLOURS), strict=True)
    ]


def test_both_robots_stand_beside_each_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_lesson(Path("lesson.rrd"), (SIM, HW), rows=101)
    words = "export lesson.rrd lesson.csv --video both.mp4 --from 0.36 --to 0.44 --json"
    assert app.run(words.split()) == 0
    assert json.loads(capsys.readouterr().out) == {
        "result": True, "robots": ["ada (hw)", "ada (sim)"], "file": "lesson.csv", "rows": 5, "video": "both.mp4",
        "frames": 3, "left_out": 0,
    }  # fmt: skip
    times_s, pictures = decoded(Path("both.mp4"))
    assert times_s == pytest.approx([k / 25 for k in range(3)], abs=1 / 45_000)
    last = pictures[-1]
    assert last.shape == (PANEL[1], 2 * PANEL[0], 3)
    samples = read(Path("lesson.rrd")).robots[SIM]
    wanted = PoseRenderer(Figure(), *PANEL).picture(samples.arms[22], samples.head[22])
    for column in (0, PANEL[0]):
        shown = last[60:, column : column + PANEL[0]]
        assert np.abs(shown.astype(int) - wanted[60:]).mean() < 3


def test_a_film_of_an_eye_has_each_whole_picture_at_its_time_and_says_how_many_it_leaves_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = [jpeg(colour) for colour in COLOURS]
    path = tmp_path / "lesson.rrd"
    write_lesson(path, (SIM, HW), rows=101, more=eye(SIM, "left", [whole[0], whole[1][:50], *whole[2:]]))
    assert app.run(["export", str(path), "--video", str(tmp_path / "eye.mp4"), "--eye", "left"]) == 0
    assert capsys.readouterr().out.endswith(" 1 damaged or repeated pictures are left out.\n")
    times_s, pictures = decoded(tmp_path / "eye.mp4")
    assert times_s == pytest.approx([ms / 1000 for ms in TIMES_MS if ms != TIMES_MS[1]], abs=1e-3)
    assert np.abs(pictures[1][24, 32].astype(int) - COLOURS[2]).max() < 12


# -- sound in recordings ----------------------------------------------------------------------------


RATE, BLOCK = 48_000, 960


def pcm(number: int) -> npt.NDArray[np.int16]:
    """Return a block of noise, the extreme values among it."""
    samples = np.random.default_rng(number).integers(-(2**15), 2**15, (BLOCK, 2)).astype(np.int16)
    samples[0] = -(2**15), 2**15 - 1
    return samples


def block(number: int) -> Sound:
    """Return a block as a subscription decodes it."""
    samples = pcm(number).astype(np.float32) / np.float32(32768)
    at_ns = number * STEP_NS
    return Sound(
        samples=samples, rate=RATE, t_mono_ns=at_ns, t_wall_ns=BEGAN_NS + at_ns, seq=number, source="tone"
    )


def rows(numbers: Sequence[int], place: tuple[str, str] = SIM) -> list[RecordingRow]:
    return [row for number in numbers for row in rows_of(place, block(number), BEGAN_NS + number * STEP_NS)]


def test_levels_and_waveform_are_those_of_the_block() -> None:
    first, level, *wave_rows = rows_of(SIM, block(7), BEGAN_NS)
    assert isinstance(first, SoundRow)
    assert isinstance(level, Numbers)
    assert level.values == pytest.approx((-4.8, -4.8), abs=0.3), "uniform noise at full scale"
    assert [row.time_ns - BEGAN_NS for row in wave_rows] == [0, STEP_NS // 2]
    (left, right), *_ = [row.values for row in wave_rows if isinstance(row, Numbers)]
    assert left == 1.0
    assert right == pytest.approx(-1.0, abs=1e-4)


def test_export_writes_a_wav_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lesson, sound = tmp_path / "lesson.rrd", tmp_path / "lesson.wav"
    late = list(rows_of(SIM, block(1), BEGAN_NS + STEP_NS + 5_000_000))  # stamps tremble
    write_lesson(lesson, [SIM, HW], 50, [*rows([0]), *late, *rows([2, 4, 6]), *rows([5], HW)])
    words = ["export", str(lesson), "--sound", str(sound), "--on", "sim", "--to", "0.1", "--json"]
    assert app.run(words) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["seconds"], document["lost_s"]) == (0.1, 0.02)
    with wave.open(str(sound)) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (2, 2, RATE)
        published = np.vstack([pcm(0), pcm(1), pcm(2), np.zeros_like(pcm(3)), pcm(4)])
        assert file.readframes(file.getnframes()) == published.tobytes()
