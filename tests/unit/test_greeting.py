"""A board that may have been reset is left in silence; one that speaks is greeted at once."""

from __future__ import annotations

import itertools

import pytest

from beatrix_zenoh.board.greeting import BOOT_S, HELLO_S, LOADER_S, STRANGER_S, TRIES, Greeting

STEP_S = 0.01
LOADER_LISTENS_S, LOADER_WAITS_S = 0.9, 5.0
"""Of the boot loader: if nobody speaks, and after the last word (tests/nodes/test_boot_loader.py has the real one)."""


def times(greeting: Greeting, until_s: float, *, stranger: bool = False) -> list[float]:
    """When HELLO is said from 0 on, seconds."""
    said = []
    for now in itertools.takewhile(lambda t: t < until_s, (n * STEP_S for n in itertools.count())):
        if greeting.due(now):
            greeting.said(now, stranger=stranger)
            said.append(now)
    return said


def test_a_board_that_starts_is_not_spoken_to() -> None:
    first, *rest = times(Greeting(0.0, BOOT_S), 20.0)
    assert first == pytest.approx(BOOT_S, abs=STEP_S)
    assert first > LOADER_LISTENS_S
    assert rest[0] - first == pytest.approx(HELLO_S, abs=2 * STEP_S)


def test_between_greetings_there_is_silence_for_any_boot_loader() -> None:
    said = times(Greeting(0.0, 0.0), 30.0)
    pauses = [later - earlier for earlier, later in itertools.pairwise(said)]
    assert [pause > LOADER_WAITS_S for pause in pauses[: 2 * TRIES]] == 2 * ([False] * (TRIES - 1) + [True])


def test_who_speaks_is_greeted_at_once_and_no_more_often_than_usual() -> None:
    greeting = Greeting(0.0, BOOT_S)
    greeting.heard()
    assert greeting.due(0.0)
    greeting.said(0.0, stranger=False)
    greeting.heard()
    assert not greeting.due(HELLO_S / 2)
    assert greeting.due(HELLO_S)


def test_after_a_loss_there_is_silence_unless_somebody_speaks() -> None:
    greeting = Greeting(0.0, 0.0)
    greeting.said(0.0, stranger=False)
    greeting.lost(1.0)
    assert not greeting.due(1.0 + LOADER_WAITS_S)
    assert greeting.due(1.0 + LOADER_S)
    greeting.heard()
    assert greeting.due(1.0)


def test_a_word_to_a_board_that_is_not_known_begins_the_silence_anew() -> None:
    greeting = Greeting(0.0, BOOT_S)
    greeting.lost(1.0)
    greeting.spoken(3.0)
    assert not greeting.due(3.0 + LOADER_WAITS_S)
    assert greeting.due(3.0 + LOADER_S)
    greeting.heard()
    assert greeting.due(3.0), "it has answered"


def test_strangers_are_greeted_so_rarely_that_their_motion_ends() -> None:
    said = times(Greeting(0.0, 0.0), 10.0, stranger=True)
    assert min(later - earlier for earlier, later in itertools.pairwise(said)) > STRANGER_S - STEP_S
