"""Photos and films of the window: a real process draws the poses that the link has received."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import av
import pytest
from gui_worlds import positions
from robots import EVENT_S, until

from gui.console.link.connection import Session
from gui.console.link.filming import FILM_S, LONGEST_S, PERIOD_S, Filming, ended
from gui.console.link.jobs import Jobs
from gui.console.state.actions import TakePicture
from gui.console.state.world import PictureProgress

PHOTO, FILM = (TakePicture(film, ("sim",), ("",), "ben · bea1") for film in (False, True))


@pytest.fixture
def filming(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Filming]:
    monkeypatch.chdir(tmp_path)
    jobs, monitor = Jobs("test"), SimpleNamespace(positions=lambda _robot, _side: positions())
    session = cast("Session", SimpleNamespace(monitor=monitor, twin=SimpleNamespace(name="bea1")))
    made = Filming(jobs, lambda: session)
    yield made
    made.close()
    jobs.close()
    jobs.join(time.monotonic() + EVENT_S)


def finished(filming: Filming) -> Any:
    until(lambda: bool(filming.progress().file or filming.progress().trouble), "the picture is written")
    return filming.progress()


def test_a_film_becomes_a_file_in_the_working_directory(filming: Filming, tmp_path: Path) -> None:
    filming.take(FILM)
    until(lambda: (filming.progress().seconds or 0.0) > 0.3, "the film runs")
    filming.end()
    film = finished(filming).file
    assert (film.parent, filming.progress().seconds) == (tmp_path / "pictures", None)
    with av.open(str(film)) as pictures:
        assert sum(1 for _ in pictures.decode(video=0)) >= 5


def test_a_folder_that_cannot_be_made_is_reported(filming: Filming, tmp_path: Path) -> None:
    (tmp_path / "pictures").write_text("no folder")
    filming.take(PHOTO)
    found = finished(filming)
    assert (found.file, found.trouble.key) == (None, "trouble.picture")
    assert "pictures" in found.trouble.detail


@pytest.mark.parametrize(
    ("seconds", "moves", "ends"),
    [(FILM_S / 2, False, False), (FILM_S, False, True), (FILM_S, True, False), (LONGEST_S, True, True)],
)
def test_a_film_ends_when_the_robots_rest_and_after_a_minute(seconds: float, moves: bool, ends: bool) -> None:
    moments: list[tuple[tuple[float, ...], ...]] = [
        ((float(moves and moment % 7),),) for moment in range(round(seconds / PERIOD_S))
    ]
    assert ended(moments) is ends


def test_a_closed_window_ends_its_film_and_leaves_no_process(filming: Filming, tmp_path: Path) -> None:
    filming.take(FILM)
    until(lambda: (filming.progress().seconds or 0.0) > 0.1, "the film runs")
    filming.close()
    until(lambda: filming.progress() == PictureProgress(), "nothing runs")
    assert not [*tmp_path.iterdir()]
