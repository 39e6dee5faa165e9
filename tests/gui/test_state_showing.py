"""*Photo* and *Film*: which robots they show, what they say meanwhile, and where the file is."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_worlds import BOTH, NOT_SIM, NOWHERE, absent, state_after, world

from gui.console.state.actions import EndFilm, OpenPicture, TakePicture
from gui.console.state.intents import Choose, Stop
from gui.console.state.world import PictureProgress, Trouble, World

FILE = Path("/tmp/bea1.png")


@pytest.mark.parametrize(
    ("choices", "now", "sides", "titles"),
    [
        ((), world(), ("sim",), ("",)),
        ((NOT_SIM, BOTH), world(), ("hw",), ("",)),
        ((BOTH,), world(), ("sim", "hw"), ("Simulation", "Hardware")),
        ((NOT_SIM,), world(), ("sim", "hw"), ("Simulation", "Hardware")),
        ((NOT_SIM, BOTH), world(hw=absent("hw")), ("sim",), ("",)),
        ((), NOWHERE, (), ("",)),
    ],
)
def test_the_checked_robots_are_shown_else_all(
    choices: tuple[Choose, ...], now: World, sides: tuple[str, ...], titles: tuple[str, ...]
) -> None:
    state = state_after(*choices)
    view = state.view(now).show
    assert {view.photo.enabled, view.film.toggle.enabled} == {bool(sides)}
    assert view.photo.intent == TakePicture(False, sides, titles, "ben · bea1")
    assert state.handle(view.film.toggle.intent, now) == [TakePicture(True, sides, titles, "ben · bea1")]


def test_a_film_shows_its_clock_and_a_second_press_ends_it() -> None:
    view = state_after().view(world(picture=PictureProgress(seconds=9.96))).show
    assert (view.film.text, view.film.toggle.intent) == ("0:09", EndFilm())
    assert not view.photo.enabled
    view = state_after().view(world(picture=PictureProgress(writing=True, file=FILE))).show
    assert {view.photo.enabled, view.film.toggle.enabled} == {False}


def test_the_last_line_shows_the_file_or_why_there_is_none_until_the_next_request() -> None:
    state = state_after()
    take = state.view(world()).show.photo.intent
    state.handle(take, world())
    kept = world(picture=PictureProgress(file=FILE))
    assert str(FILE) in state.view(kept).last
    opens = state.view(kept).show.film.open
    assert opens is not None
    assert state.handle(opens.intent, kept) == [OpenPicture(FILE)]
    failed = world(picture=PictureProgress(file=FILE, trouble=Trouble("trouble.picture", detail="disk full")))
    assert state.view(failed).last_detail == "disk full"
    state.handle(take, failed)
    assert str(FILE) in state.view(kept).last, "the news of the newest picture"
    state.handle(Stop(), kept)
    assert str(FILE) not in state.view(kept).last
