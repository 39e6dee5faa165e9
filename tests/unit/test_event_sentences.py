"""Events in words: a motion is written as it was requested, so that a reader can repeat it."""

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
from beatrix_zenoh.contract.sentences.events import angle, request, sentence


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
