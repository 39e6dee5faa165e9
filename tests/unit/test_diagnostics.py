"""Warnings in the status."""

from __future__ import annotations

from collections.abc import Callable

from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.node.events import RESTARTED, SHOWN_S, Diagnostics, NodeEvents


def diagnostics(now_s: Callable[[], float] = lambda: 0.0) -> tuple[Diagnostics, NodeEvents]:
    events = NodeEvents()
    return Diagnostics(events, now_s), events


def test_a_repeated_sentence_is_shown_once() -> None:
    made, _ = diagnostics()
    for text in ("one", "two", "one"):
        made.warn(text)
    assert made.warnings() == ["two", "one"]


def test_every_warning_is_an_event() -> None:
    made, events = diagnostics()
    made.warn("one")
    (event,) = events.take()
    assert (event.kind, event.message) == (EventKind.WARNING, "one")


def test_a_restart_is_one_event_and_a_warning_until_the_board_is_calibrated() -> None:
    now_s = 0.0
    made, events = diagnostics(lambda: now_s)
    made.follow_boot(1, calibrated=True)
    assert made.warnings() == []
    made.follow_boot(2, calibrated=False)
    made.follow_boot(2, calibrated=False)
    assert [(event.kind, event.message) for event in events.take()] == [(EventKind.BOARD, RESTARTED)]
    made.warn("something else")
    assert made.warnings() == [RESTARTED, "something else"]
    now_s = SHOWN_S + 1
    assert made.warnings() == [RESTARTED]
    made.follow_boot(2, calibrated=True)
    assert made.warnings() == []
    made.follow_boot(2, calibrated=False)
    assert made.warnings() == []
