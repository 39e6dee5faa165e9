"""The recorder's thread: samples that wait for a clock, dropped samples, and errors that end the thread."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from typing import Any, cast
from unittest.mock import Mock

import msgspec
import pytest
from golden import same
from robots import until
from statuses import AT_HOME, READY

from beatrix_zenoh.client.robot_base import Offset
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.contract._generated.messages import Positions, Status
from beatrix_zenoh.contract.codec import decode_json
from beatrix_zenoh.recording.losses import POSITIONS, Stream, total
from beatrix_zenoh.recording.recorder import Recorder
from beatrix_zenoh.recording.rows import Bar, Line, Numbers, RecordingRow
from beatrix_zenoh.recording.samples import About, Note
from beatrix_zenoh.recording.sources import (
    Arrived,
    RobotAnswer,
    Value,
)

BEA = ("bea", "hw")
AHEAD_NS = 3_600_000_000_000
"""Time by which the robot's clock is ahead of the recorder's."""


class Inbox:
    """Delivers what the test has put in: publications, answers to queries, or notes."""

    def __init__(self) -> None:
        self.waiting: list[Any] = []
        self.dropped: dict[Stream, int] = {}
        self.requests: list[tuple[str, str]] = []
        self.request = self.requests.append

    def take(self) -> list[Any]:
        taken, self.waiting = self.waiting, []
        return taken

    answers = take

    def close(self) -> None:
        pass


class Rig:
    """A recorder's thread with fake subscriptions, queries and output."""

    def __init__(self) -> None:
        self.subscriptions, self.queries, self.notes = Inbox(), Inbox(), Inbox()
        self.output, self.messages = Mock(**{"update.return_value": False}), list[str]()
        subscriptions, queries, notes = (
            cast("Any", inbox) for inbox in (self.subscriptions, self.queries, self.notes)
        )
        about = About(7, title="lesson")
        outputs = cast("Any", [self.output])
        self.thread = Recorder(subscriptions, queries, outputs, self.messages.append, 0.0, about, notes)

    def publish(self, value: Positions | Status) -> None:
        """Deliver a publication now."""
        arrival = Arrival[Value](value, *BEA, time.monotonic_ns(), time.time_ns())
        self.subscriptions.waiting.append(arrival)

    def answer(self, offset_ns: int | None) -> None:
        """Deliver an answer with this clock offset; None stands for an answer without an offset."""
        offset = None if offset_ns is None else Offset(offset_ns / 1e9, 1e-4)
        self.queries.waiting = [RobotAnswer(BEA, offset)]

    def rows(self) -> list[RecordingRow]:
        """Return the rows that were written so far."""
        return [row for call in self.output.write.call_args_list for row in call.args[0]]

    def numbers(self, what: str) -> list[Numbers]:
        """Return those of an entity of the robot."""
        return [row for row in self.rows() if isinstance(row, Numbers) and row.path == f"bea/hw/{what}"]

    def arms(self) -> list[Numbers]:
        return self.numbers("arms")


@pytest.fixture
def rig() -> Iterator[Rig]:
    made = Rig()
    yield made
    made.thread.close()


numbers = itertools.count()
"""Sequence numbers of positions."""


def positions(ahead_ns: int = AHEAD_NS) -> Positions:
    """Return positions of this moment, with the time stamp of a clock that is ahead by `ahead_ns`."""
    return msgspec.structs.replace(
        AT_HOME, seq=next(numbers), t_mono_ns=time.monotonic_ns() + ahead_ns, t_wall_ns=7
    )


def test_publications_are_kept_until_the_clock_offset_is_known(rig: Rig) -> None:
    rig.publish(positions())
    until(lambda: rig.queries.requests == [BEA], "one request")
    rig.publish(positions())
    until(lambda: not rig.subscriptions.waiting, "both publications were taken")
    assert rig.arms() == []
    rig.answer(AHEAD_NS)
    until(lambda: len(rig.arms()) == 2, "both publications are written")
    assert abs(rig.arms()[0].time_ns - time.time_ns()) < 5_000_000_000
    assert rig.queries.requests == [BEA]
    assert [list(call.args[0].robots) for call in rig.output.show.call_args_list] == [[BEA]]


def test_dropped_publications_are_reported_and_recorded(rig: Rig) -> None:
    rig.subscriptions.dropped = {(BEA, POSITIONS): 12}
    until(lambda: bool(rig.messages), "the message")
    assert rig.messages == [
        "So far: bea (hw): 12 of 12 positions were dropped here: this computer was too slow."
    ]
    (line,) = rig.rows()
    assert isinstance(line, Line)
    assert (line.path, line.text) == ("_recorder/log", rig.messages[0])


def test_only_publications_with_impossible_time_stamps_are_dropped(rig: Rig) -> None:
    rig.answer(AHEAD_NS)
    rig.publish(positions())
    until(lambda: len(rig.arms()) == 1, "the robot is known")
    now_ns = time.monotonic_ns() + AHEAD_NS
    for mono_ns, wall_ns in ((-(2**63), 7), (2**63 - 1, 7), (now_ns, -(2**63))):
        rig.publish(msgspec.structs.replace(READY, t_mono_ns=mono_ns, t_wall_ns=wall_ns))
    rig.publish(positions())
    until(lambda: len(rig.arms()) == 2, "the correct one is written at once")
    assert total(rig.thread.counts).impossible == 3
    assert rig.queries.requests == []
    until(lambda: bool(rig.messages), "the message")
    assert "impossible time stamps" in rig.messages[0]


def test_late_samples_are_written_with_their_true_times(rig: Rig) -> None:
    rig.answer(AHEAD_NS)
    rig.publish(positions())
    until(lambda: len(rig.arms()) == 1, "the robot is known")
    for _ in range(2):
        rig.publish(positions(AHEAD_NS - 60_000_000_000))  # under way for a minute
    until(lambda: len(rig.queries.requests) == 1, "the clock offset is measured again")
    rig.answer(AHEAD_NS)
    until(lambda: len(rig.arms()) == 3, "late samples are written")
    assert rig.arms()[1].time_ns - rig.arms()[0].time_ns < -50_000_000_000
    assert total(rig.thread.counts).late == 2
    assert total(rig.thread.counts).unwritten == 0
    until(lambda: bool(rig.messages), "the message")
    same("recording thread.late samples are written with their true times", rig.messages[0])


def test_a_note_becomes_a_line_and_a_mark(rig: Rig) -> None:
    rig.notes.waiting.append(Arrived("ana", "trial 3 begins", time.monotonic_ns()))
    until(lambda: len(rig.rows()) == 2, "both rows")
    line, mark = rig.rows()
    assert isinstance(line, Line)
    assert isinstance(mark, Bar)
    assert line.path == "_recorder/notes"
    assert line.text.endswith("  note by ana:  trial 3 begins")
    assert decode_json(line.json.encode(), Note) == Note(line.time_ns, "ana", "trial 3 begins")
    assert abs(line.time_ns - time.time_ns()) < 5_000_000_000
    assert (mark.state, mark.time_ns) == ("trial 3 begins", line.time_ns)


def test_an_output_that_has_restarted_gets_robots_and_description_again(rig: Rig) -> None:
    """A new file of `--rotate`, or a viewer that was started later, shows the same robots."""
    rig.publish(positions())
    rig.answer(AHEAD_NS)
    until(lambda: len(rig.arms()) == 1, "the robot is in the recording")
    rig.output.show.reset_mock()
    rig.output.describe.reset_mock()
    rig.output.update.side_effect = itertools.chain([True], itertools.repeat(False))
    until(lambda: rig.output.show.called and rig.output.describe.called, "the output has both again")
    assert list(rig.output.show.call_args.args[0].robots) == [BEA]
    assert rig.output.describe.call_args.args[0].title == "lesson"


def test_an_error_ends_the_thread_and_is_reported(rig: Rig) -> None:
    rig.output.update.side_effect = OSError("gone")
    with pytest.raises(OSError, match="gone"):
        until(lambda: bool(rig.thread.check()), "the thread has failed")  # type: ignore[func-returns-value]
    assert rig.thread.close()
    assert rig.output.close.called


def test_positions_of_a_lost_board_are_counted_and_not_written_in_the_past(rig: Rig) -> None:
    """The node repeats the last positions; those of an hour ago would stretch the time line."""
    rig.answer(AHEAD_NS)
    old = msgspec.structs.replace(positions(AHEAD_NS - 3_600_000_000_000), repeated=True)
    for _ in range(3):
        rig.publish(msgspec.structs.replace(old, seq=next(numbers)))
    rig.publish(positions())
    until(lambda: len(rig.arms()) == 1, "the new sample is written")
    assert [row.values for row in rig.numbers("repeats")] == [(3.0,)]
    (one,) = rig.thread.counts.values()
    assert (one.received, one.repeated, one.impossible, one.late) == (4, 3, 0, 0)
    assert rig.queries.requests == [], "the clock is not measured again"
