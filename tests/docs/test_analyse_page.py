"""The commands and the Python of the page about analysing a recording run as printed, and its columns exist."""

from __future__ import annotations

import io
import re
import shlex
import shutil
from pathlib import Path

import pytest
from PIL import Image
from written_recordings import BEGAN_NS, STEP_NS, times, write_lesson

from beatrix_zenoh.cli import app
from beatrix_zenoh.recording import film
from beatrix_zenoh.recording.export import quantities
from beatrix_zenoh.recording.rows import Frame, Numbers
from beatrix_zenoh.recording.rrd.read import read

PAGE = Path(__file__).resolve().parents[2] / "docs/how-to/analyse.md"
TEXT = PAGE.read_text(encoding="utf-8")
PLACES = ("bea1", "sim"), ("bea1", "hw")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the recordings of the page."""
    made = tmp_path_factory.mktemp("page")
    file = io.BytesIO()
    Image.new("RGB", (64, 48)).save(file, "JPEG")
    pictures = [Frame("bea1/sim/camera/left", at_ns, file.getvalue()) for at_ns in times(2)]
    write_lesson(made / "lesson.rrd", PLACES, rows=100, more=pictures)
    later = [
        Numbers(f"bea1/hw/{what}", time_ns, (1.0, 2.0, 3.0))
        for what in ("arms", "commanded", "head")
        for time_ns in (BEGAN_NS + 300 * STEP_NS, BEGAN_NS + 301 * STEP_NS)
    ]
    write_lesson(made / "day-001.rrd", PLACES)
    write_lesson(made / "day-002.rrd", (), rows=0, more=later)
    return made


@pytest.fixture(autouse=True)
def here(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a copy of the folder."""
    monkeypatch.chdir(shutil.copytree(folder, tmp_path, dirs_exist_ok=True))


@pytest.mark.long("draws films")
def test_the_commands_of_the_page_write_its_files(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(film, "PANEL", (64, 48))  # the drawing of large films takes most of the time
    blocks = re.findall(r"```sh\n(.*?)```", TEXT, re.DOTALL)
    for line in "".join(blocks).splitlines():
        words = shlex.split(line, comments=True)
        assert words[0] == "beatrix"
        assert app.run(words[1:]) == 0, line
    out = capsys.readouterr().out
    assert [int(rows) for rows in re.findall(r": (\d+) rows", out)] == [100, 50, 302, 50]
    assert [int(frames) for frames in re.findall(r": (\d+) frames", out)] == [50, 2, 25]


def test_the_python_of_the_page_loads_a_recording(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert app.run(["export", "lesson.rrd", "lesson.csv"]) == 0
    table, recording = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    found: dict[str, object] = {}
    exec(table, found)
    assert capsys.readouterr().out.splitlines()[-1] == "0.0"
    exec(recording, found)
    assert capsys.readouterr().out.splitlines()[-1] == "[100 rows x 2 columns]"
    head = read(folder / "lesson.rrd").robots["bea1", "sim"].head
    loaded = found["head"]["/bea1/sim/head:Scalars:scalars"]  # type: ignore[index]
    assert [list(row) for row in loaded] == head.tolist()


def test_every_column_is_named_on_the_page(folder: Path) -> None:
    samples = read(folder / "lesson.rrd").robots["bea1", "sim"]
    for column, _ in quantities(samples):
        axis, kind = column.split("_", 1)
        first = {"middle": "short", "long": "short", "pitch": "yaw", "roll": "yaw"}.get(axis, axis)
        assert f"bea1_sim_{first}_{kind}" in TEXT
        assert axis in TEXT
