"""Events in words: a motion is written as it was requested, so that a reader can repeat it; and in words for people."""

from __future__ import annotations

import math
import struct

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
    Source,
    Vector3,
)
from beatrix_zenoh.contract.sentences.events import angle, plain_sentence, request, sentence


def rad(degrees: float) -> float:
    """Return an angle in rad, as a message transports it."""
    (single,) = struct.unpack("<f", struct.pack("<f", math.radians(degrees)))
    return float(single)


def vector(short: float, middle: float, long: float) -> Vector3:
    return Vector3(rad(short), rad(middle), rad(long))


LOOK = PoseQuery(yaw=rad(20), speed=rad(40), lead=2.0, source=Source.WINDOW)
ACCEPTED = Event(
    seq=1,
    t_mono_ns=0,
    t_wall_ns=0,
    kind=EventKind.MOTION,
    action="pose",
    seat="ana",
    phase=Phase.ACCEPTED,
    message="Accepted: 0.6 s.",
    motion=17,
    source=Source.WINDOW,
    pose_query=LOOK,
    position=vector(20.0, 20.0, 19.98),
)
OTHER: dict[str, object] = {"source": None, "pose_query": None, "position": None}
CASES: dict[str, dict[str, object]] = {
    "accepted": {},
    "refused": {"reason": Reason.ARM_GAP, "message": "Too close.", "motion": 0, "position": None},
    "repeated": {"count": 12},
    "done": {"phase": Phase.DONE, "message": "Arrived.", "source": None, "pose_query": None},
    "command refused": OTHER
    | {"kind": EventKind.COMMAND, "action": "ENABLE", "phase": None, "source": Source.CLI, "motion": 0}
    | {"reason": Reason.EMERGENCY, "message": "No."},
    "board": OTHER
    | {
        "kind": EventKind.BOARD,
        "action": "",
        "seat": "",
        "phase": None,
        "motion": 0,
        "message": "It is connected.",
    },
}
REQUESTS: dict[str, MotionQuery | PoseQuery] = {
    "look": PoseQuery(yaw=rad(-0.05)),
    "look relative": PoseQuery(absolute=False, pitch=rad(2.5), lead=0.0),
    "move": MotionQuery(position=vector(5, -5, 0), speed=vector(30, 30, 30)),
    "move relative": MotionQuery(absolute=False, position=vector(0, 0, 1.125), speed=vector(20, 30.5, 40)),
}


@pytest.mark.parametrize("case", CASES)
def test_an_event_is_one_sentence(case: str) -> None:
    same(f"event.{case}", sentence(msgspec.structs.replace(ACCEPTED, **CASES[case])))


@pytest.mark.parametrize("case", REQUESTS)
def test_a_request_is_written_as_it_was_made(case: str) -> None:
    same(f"request.{case}", request(REQUESTS[case]))


@given(st.floats(-360, 360))
def test_an_angle_in_words_is_exact_to_a_thousandth_of_a_degree(degrees: float) -> None:
    assert float(angle(rad(degrees)).removesuffix("°")) == pytest.approx(degrees, abs=6e-4)


# -- in words for people: no numbers of motions, no names of fields, directions instead of signs ------------------

TURN = PoseQuery(yaw=math.radians(26), pitch=math.radians(-8))
SHOWN = Event(
    seq=1, t_mono_ns=0, t_wall_ns=0, kind=EventKind.MOTION, action="pose", seat="ana", phase=Phase.ACCEPTED,
    message="Accepted: 1.4 s.", motion=17, duration=1.4, pose_query=TURN,
)  # fmt: skip


NO_POSE: dict[str, object] = {"pose_query": None}
COMMAND: dict[str, object] = NO_POSE | {"kind": EventKind.COMMAND, "action": "ENABLE", "phase": None}
NO_SEAT: dict[str, object] = NO_POSE | {"seat": "", "phase": None}
PLAIN: dict[str, dict[str, object]] = {
    "look": {},
    "look ahead": {"pose_query": PoseQuery(), "duration": 0.66},
    "look with lead": {"pose_query": msgspec.structs.replace(TURN, lead=1.5)},
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


@pytest.mark.parametrize("case", PLAIN)
def test_an_event_is_a_sentence_for_people(case: str) -> None:
    same(f"event for people.{case}", plain_sentence(msgspec.structs.replace(SHOWN, **PLAIN[case])))


@given(st.sampled_from(EventKind), st.sampled_from(Reason), st.sampled_from([None, *Phase]), st.booleans())
def test_every_event_keeps_its_message_or_its_duration(
    kind: EventKind, reason: Reason, phase: Phase | None, asked: bool
) -> None:
    event = msgspec.structs.replace(
        SHOWN, kind=kind, reason=reason, phase=phase, pose_query=TURN if asked else None
    )
    text = plain_sentence(event)
    assert event.message in text or f"({event.duration:.1f} s)" in text
    assert "_" not in text
    assert "  " not in text
