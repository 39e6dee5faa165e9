"""Events in words: a motion is written as it was requested, so that a reader can repeat it."""

from __future__ import annotations

import math
import struct

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
    Source,
    Vector3,
)
from beatrix_zenoh.contract.sentences.events import FROM, angle, request, sentence


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
ASKED = "ana asked look yaw 20.0°, pitch 0.0°, roll 0.0° at 40°/s, lead 2 s, from the window"


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, f"{ASKED}: Accepted: 0.6 s. Motion 17 to arms 20.0°, 20.0°, 19.98°."),
        (
            {"reason": Reason.ARM_GAP, "message": "Too close.", "motion": 0, "position": None},
            f"{ASKED}, refused ARM_GAP: Too close.",
        ),
        ({"count": 12}, f"{ASKED} (12 times): Accepted: 0.6 s. Motion 17 to arms 20.0°, 20.0°, 19.98°."),
        (
            {"phase": Phase.DONE, "message": "Arrived.", "source": None, "pose_query": None},
            "ana motion pose 17 done: Arrived.",
        ),
        (
            {
                "kind": EventKind.COMMAND,
                "action": "ENABLE",
                "phase": None,
                "source": Source.CLI,
                "pose_query": None,
                "motion": 0,
                "reason": Reason.EMERGENCY,
                "message": "No.",
                "position": None,
            },
            "ana command ENABLE, from the command line, refused EMERGENCY: No.",
        ),
        (
            {"kind": EventKind.BOARD, "action": "", "seat": "", "phase": None, "source": None}
            | {"pose_query": None, "motion": 0, "message": "The board is connected.", "position": None},
            "board: The board is connected.",
        ),
    ],
)
def test_an_event_is_one_sentence(changes: dict[str, object], text: str) -> None:
    assert sentence(msgspec.structs.replace(ACCEPTED, **changes)) == text


@pytest.mark.parametrize(
    ("query", "text"),
    [
        (PoseQuery(yaw=rad(-0.05)), "look yaw -0.05°, pitch 0.0°, roll 0.0° at the default speed"),
        (
            PoseQuery(absolute=False, pitch=rad(2.5), lead=0.0),
            "look relative yaw 0.0°, pitch 2.5°, roll 0.0° at the default speed, lead 0 s",
        ),
        (
            MotionQuery(position=vector(5, -5, 0), speed=vector(30, 30, 30)),
            "move short 5.0°, middle -5.0°, long 0.0° at 30°/s",
        ),
        (
            MotionQuery(absolute=False, position=vector(0, 0, 1.125), speed=vector(20, 30.5, 40)),
            "move relative short 0.0°, middle 0.0°, long 1.125° at 20, 30.5, 40°/s",
        ),
    ],
)
def test_a_request_is_written_as_it_was_made(query: MotionQuery | PoseQuery, text: str) -> None:
    assert request(query) == text


@given(st.floats(-360, 360))
def test_an_angle_in_words_is_exact_to_a_thousandth_of_a_degree(degrees: float) -> None:
    assert float(angle(rad(degrees)).removesuffix("°")) == pytest.approx(degrees, abs=6e-4)


def test_every_source_has_words() -> None:
    assert set(FROM) == set(Source)
