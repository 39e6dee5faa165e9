"""Events in words for people: no numbers of motions, no names of fields, directions instead of signs."""

from __future__ import annotations

import math

import msgspec
import pytest
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


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, "ana: look left 26°, up 8° (1.4 s)"),
        ({"pose_query": PoseQuery(), "duration": 0.66}, "ana: look straight ahead (0.7 s)"),
        ({"pose_query": msgspec.structs.replace(LOOK, lead=1.5)}, "ana: look left 26°, up 8°, lead 1.5 s (1.4 s)"),
        (
            {"pose_query": PoseQuery(yaw=-0.5, roll=math.radians(-10), absolute=False)},
            "ana: look further right 28.6°, tilt left 10° (1.4 s)",
        ),
        (
            {"pose_query": None, "motion_query": MotionQuery(position=vector(20, -20, 0.04))},
            "ana: arms short 20°, middle -20°, long 0° (1.4 s)",
        ),
        (
            {
                "pose_query": None,
                "motion_query": MotionQuery(position=vector(5, 5, 5), absolute=False, speed=vector(60, 30, 30)),
            },
            "ana: arms further by short 5°, middle 5°, long 5°, at 60°, 30°, 30° per second (1.4 s)",
        ),
        (
            {"reason": Reason.OUT_OF_REACH, "message": "The head would tilt 60.0°."},
            "ana: look left 26°, up 8° refused: The head would tilt 60.0°.",
        ),
        (
            {"phase": Phase.DONE, "pose_query": None, "message": "Arrived; the arms rest at 1.0°, 2.0°, 3.0°."},
            "ana: Arrived; the arms rest at 1.0°, 2.0°, 3.0°.",
        ),
        (
            {"phase": Phase.DONE, "pose_query": None, "reason": Reason.STOPPED, "message": "Ended by STOP."},
            "ana: Ended by STOP.",
        ),
        (
            {"kind": EventKind.COMMAND, "action": "ENABLE", "phase": None, "pose_query": None, "message": "On."},
            "ana: On.",
        ),
        (
            {"kind": EventKind.COMMAND, "action": "ENABLE", "phase": None, "pose_query": None}
            | {"reason": Reason.EMERGENCY, "message": "No.", "count": 3},
            "ana: enable refused: No. (3 times)",
        ),
        (
            {"kind": EventKind.LEASE, "action": "", "phase": None, "pose_query": None, "message": "ana drives."},
            "ana drives.",
        ),
        (
            {"kind": EventKind.STOP, "action": "EMERGENCY_STOP", "seat": "", "phase": None, "pose_query": None}
            | {"message": "The motors are off."},
            "unknown seat: EMERGENCY STOP: The motors are off.",
        ),
        (
            {"kind": EventKind.LOG, "action": "WARNING", "seat": "", "phase": None, "pose_query": None}
            | {"message": "The disk is slow."},
            "The disk is slow.",
        ),
    ],
)  # fmt: skip
def test_an_event_is_a_sentence_for_people(changes: dict[str, object], text: str) -> None:
    assert plain_sentence(msgspec.structs.replace(EVENT, **changes)) == text


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
