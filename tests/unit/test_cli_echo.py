"""The line that `beatrix echo` prints for an event."""

from __future__ import annotations

import time

import msgspec
import pytest

from beatrix_zenoh.cli.streams import event_line
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Phase, Reason

NOON_NS = round(time.mktime((2026, 11, 22, 12, 0, 0, 0, 0, -1)) * 1e9)
EVENT = Event(
    seq=7, t_mono_ns=0, t_wall_ns=NOON_NS + 45_678_901, kind=EventKind.MOTION, seat="ana", message="Text."
)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"action": "pose", "phase": Phase.ACCEPTED}, "ana motion pose accepted: Text."),
        (
            {"action": "pose", "phase": Phase.ACCEPTED, "reason": Reason.ARM_GAP},
            "ana motion pose refused ARM_GAP: Text.",
        ),
        ({"action": "pose", "phase": Phase.DONE}, "ana motion pose done: Text."),
        (
            {"action": "pose", "phase": Phase.DONE, "reason": Reason.STOPPED},
            "ana motion pose ended STOPPED: Text.",
        ),
        (
            {"kind": EventKind.COMMAND, "action": "ENABLE", "reason": Reason.EMERGENCY, "count": 12},
            "ana command ENABLE refused EMERGENCY (12 times): Text.",
        ),
        ({"kind": EventKind.BOARD, "seat": "", "reason": Reason.BOARD_LOST}, "board BOARD_LOST: Text."),
    ],
)
def test_an_event_is_one_line_with_time_robot_seat_and_outcome(changes: dict[str, object], line: str) -> None:
    event = msgspec.structs.replace(EVENT, **changes)
    assert event_line(("bea", "hw"), event) == f"12:00:00.045  bea (hw)  {line}"
