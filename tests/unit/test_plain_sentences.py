"""Events in words for people: no numbers of motions, no names of fields, directions instead of signs."""

from __future__ import annotations

import math

import msgspec
import pytest
from golden import same
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    MotionQuery,
    Phase,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh.contract.sentences.events import plain_sentence

LOOK = PoseQuery(yaw=math.radians(26), pitch=math.radians(-8))
EVENT = Event(
    seq=1, t_mono_ns=0, t_wall_ns=0, kind=EventKind.MOTION, action="pose", seat="ana", phase=Phase.ACCEPTED,
    message="Accepted: 1.4 s.", motion=17, duration=1.4, pose_query=LOOK,
)  # fmt: skip


def vector(*degrees: float) -> Vector3:
    return Vector3(*map(math.radians, degrees))


NO_POSE: dict[str, object] = {"pose_query": None}
COMMAND: dict[str, object] = NO_POSE | {"kind": EventKind.COMMAND, "action": "ENABLE", "phase": None}
NO_SEAT: dict[str, object] = NO_POSE | {"seat": "", "phase": None}
CASES: dict[str, dict[str, object]] = {
    "look": {},
    "look ahead": {"pose_query": PoseQuery(), "duration": 0.66},
    "look with lead": {"pose_query": msgspec.structs.replace(LOOK, lead=1.5)},
    "look further": {"pose_query": PoseQuery(yaw=-0.5, roll=math.radians(-10), absolute=False)},
    "arms": NO_POSE | {"motion_query": MotionQuery(position=vector(20, -20, 0.04))},
    "arms further": NO_POSE
    | {"motion_query": MotionQuery(position=vector(5, 5, 5), absolute=False, speed=vector(60, 30, 30))},
    "refused": {"reason": Reason.OUT_OF_REACH, "message": "Too far."},
    "done": NO_POSE | {"phase": Phase.DONE, "message": "Arrived."},
    "stopped": NO_POSE | {"phase": Phase.DONE, "reason": Reason.STOPPED, "message": "Ended by STOP."},
    "command": COMMAND | {"message": "On."},
    "command refused": COMMAND | {"reason": Reason.EMERGENCY, "message": "No.", "count": 3},
    "lease": NO_POSE | {"kind": EventKind.LEASE, "action": "", "phase": None, "message": "ana drives."},
    "stop": NO_SEAT | {"kind": EventKind.STOP, "action": "EMERGENCY_STOP", "message": "The motors are off."},
    "log": NO_SEAT | {"kind": EventKind.LOG, "action": "WARNING", "message": "The disk is slow."},
}


@pytest.mark.parametrize("case", CASES)
def test_an_event_is_a_sentence_for_people(case: str) -> None:
    same(f"event for people.{case}", plain_sentence(msgspec.structs.replace(EVENT, **CASES[case])))


@given(st.sampled_from(EventKind), st.sampled_from(Reason), st.sampled_from([None, *Phase]), st.booleans())
def test_every_event_keeps_its_message_or_its_duration(
    kind: EventKind, reason: Reason, phase: Phase | None, asked: bool
) -> None:
    event = msgspec.structs.replace(
        EVENT, kind=kind, reason=reason, phase=phase, pose_query=LOOK if asked else None
    )
    text = plain_sentence(event)
    assert event.message in text or f"({event.duration:.1f} s)" in text
    assert "_" not in text
    assert "  " not in text
