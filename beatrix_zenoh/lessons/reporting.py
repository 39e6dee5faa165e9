"""Reports of lessons: each seat of a class sends the class's router what it has reached."""

from __future__ import annotations

import contextlib
from typing import Final

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LessonState
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lessons.progress import Record
from beatrix_zenoh.settings import Settings, resolve

LONGEST_S: Final = 1.0
"""Longest time (s) that a pupil waits for a report."""
MOST: Final = 2**16 - 1


def state_of(record: Record) -> LessonState:
    """Return what a record says to the teacher: numbers, and the name of a figure."""
    return LessonState(
        version=record.version,
        tries=min(record.tries, MOST),
        hints=len(record.hints),
        figure=record.figure,
        stuck=min(record.stuck, MOST),
        passed=bool(record.passed),
    )


def report(lesson: str, record: Record) -> None:
    """Report a lesson to the class's router if this computer has an account; give up after LONGEST_S, without a word."""
    with contextlib.suppress(BeatrixError):
        settings = resolve()
        if settings.account is None:
            return
        state = state_of(record)
        threads.start(lambda: _publish(settings, lesson, state), "lesson-report").join(LONGEST_S)


def _publish(settings: Settings, lesson: str, state: LessonState) -> None:
    with (
        contextlib.suppress(BeatrixError),
        zbus.connect(settings.connect, label=settings.who, account=settings.account) as bus,
    ):
        bus.put(keys.lesson(settings.who, lesson), codec.encode(state), codec.MSGPACK)
        bus.router_answers(LONGEST_S)  # what was published before is then at the router
