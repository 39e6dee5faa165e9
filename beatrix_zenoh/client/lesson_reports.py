"""Reports of lessons: each seat of a class sends what it has reached to the router, which keeps it for the teacher."""

from __future__ import annotations

import contextlib
import time
from typing import Final, NamedTuple, TypeVar

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LessonState, Reason
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.lesson_files import NOT_MEASURED
from beatrix_zenoh.settings import Settings, resolve

M = TypeVar("M", bound=msgspec.Struct)
ANSWER_S: Final = 3.0
"""Time limit (s) for all reports of the router."""
STUCK: Final = 5
"""Checks without a new figure after which a seat counts as stuck: also one that goes back and forth between two."""
FIELDS: Final = ("seat", "lesson", "progress", "tries", "hints", "figure")
PASSED, TRYING, STUCK_AT = "passed", "trying", "stuck"
IMPOSSIBLE, SILENT = "impossible", "silent"
TRIES_MAX: Final = 1000
"""Checks of one lesson above which a report is impossible: a check takes seconds, so these are hours."""
LONGEST_S: Final = 1.0
"""Longest time (s) that a pupil waits for a report."""


def report(lesson: str, state: LessonState, settings: Settings | None = None) -> None:
    """Report a lesson to the class's router if there is an account; give up after LONGEST_S, without a word.

    settings: of the seat; None: those of this computer.
    """
    with contextlib.suppress(BeatrixError):
        settings = settings or resolve()
        if settings.account is not None:
            threads.start(lambda: _publish(settings, lesson, state), "lesson-report").join(LONGEST_S)


def _publish(settings: Settings, lesson: str, state: LessonState) -> None:
    with (
        contextlib.suppress(BeatrixError),
        zbus.connect(settings.connect, label=settings.who, account=settings.account) as bus,
    ):
        bus.put(keys.lesson(settings.who, lesson), codec.encode(state), codec.MSGPACK)
        bus.router_answers(LONGEST_S)  # what was published before is then at the router


class Row(NamedTuple):
    """What one seat has reached in one lesson."""

    seat: str
    lesson: str
    state: LessonState

    @property
    def progress(self) -> str:
        """`passed`, `not-measured`, `stuck`, `trying`, or `impossible`: no checks can have made this report."""
        state = self.state
        if max(state.passed, state.stuck) > state.tries or state.tries > TRIES_MAX:
            return IMPOSSIBLE
        if state.passed:
            return PASSED
        if state.figure == NOT_MEASURED:
            return NOT_MEASURED
        return STUCK_AT if state.stuck >= STUCK else TRYING

    @property
    def fields(self) -> dict[str, object]:
        """The row for other programs: values of FIELDS."""
        state = self.state
        values = (self.seat, self.lesson, self.progress, state.tries, state.hints, state.figure)
        return dict(zip(FIELDS, values, strict=True))

    @property
    def words(self) -> str:
        """The progress and the number of checks."""
        return f"{self.progress} ({self.state.tries})" if self.state.tries else self.progress


def silent(seat: str) -> dict[str, object]:
    """Return the fields of a seat that has reported nothing."""
    return dict(zip(FIELDS, (seat, "", SILENT, 0, 0, ""), strict=True))


def read(client: Client, timeout_s: float = ANSWER_S) -> list[Row]:
    """Return the newest report of each seat and lesson, as the class's router has it, by seat and lesson.

    Raises:
        Refused: TEACHER_ONLY, the seat is not the teacher's.
        NoAnswer: NO_ROUTER, ACCOUNT_REFUSED, or TIMED_OUT: not all reports have arrived within `timeout_s` (s).
    """
    if client.settings.who != TEACHER:
        raise Refused(
            Reason.TEACHER_ONLY,
            f"You are {client.settings.who}; only the seat `teacher` reads the reports of the class. `beatrix lesson list` "
            "shows your own lessons.",
        )
    found = kept(client, keys.lesson("*", "*"), LessonState, timeout_s)
    return sorted(
        (Row(seat, key.rpartition("/")[2], state) for seat, key, state in found), key=lambda row: row[:2]
    )


def kept(client: Client, key: str, kind: type[M], timeout_s: float = ANSWER_S) -> list[tuple[str, str, M]]:
    """Return seat, key and message of each that the class's router keeps under a key; raises NoAnswer as `read`."""
    found, bus, begin_s = [], client.bus, time.monotonic()
    for reply in bus.query(key, timeout_s=timeout_s).replies(timeout_s):
        parts = keys.parse(reply.key)
        message = None if reply.error or parts is None else client.read(reply, kind)
        if parts is not None and message is not None:
            found.append((parts.who, reply.key, message))
    # Zenoh also ends the replies of a query whose time is over, or whose router is lost.
    if time.monotonic() - begin_s >= timeout_s or not bus.router_answers(timeout_s):
        text = (
            f"The router at {bus.endpoint} has not sent all that the class has given to it within {timeout_s:g} s. "
            "Try again; `beatrix doctor` checks the router."
        )
        raise bus.refusal() or NoAnswer(Reason.TIMED_OUT, text)
    return found
