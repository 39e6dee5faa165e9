"""Whatever bytes come, the answer is a message or a refusal."""

from __future__ import annotations

import math

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import Refused, codec, requests
from beatrix_zenoh._generated.messages import (
    CommandQuery,
    MotionQuery,
    MotionReply,
    PoseQuery,
    Positions,
    Reason,
    Vector3,
)
from beatrix_zenoh.requests import Wording

KINDS = st.sampled_from([MotionQuery, PoseQuery, CommandQuery])
LONG = "q" * 100_000
FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)


@given(st.binary(max_size=200), st.sampled_from(["", "zenoh/bytes", codec.MSGPACK]), KINDS)
def test_any_payload_is_read_or_refused(
    payload: bytes, encoding: str, kind: type[MotionQuery | PoseQuery | CommandQuery]
) -> None:
    try:
        message = requests.read(Wording(payload, encoding, ""), kind)
    except Refused as error:
        refused = error
    else:
        assert isinstance(message, kind)
        return
    assert refused.reason in (Reason.BAD_VALUE, Reason.UNKNOWN_COMMAND)
    assert refused.message


@given(st.text(max_size=100), KINDS)
def test_any_parameters_are_read_or_refused(
    parameters: str, kind: type[MotionQuery | PoseQuery | CommandQuery]
) -> None:
    try:
        message = requests.read(Wording(b"", "", parameters), kind)
    except Refused as error:
        refused = error
    else:
        assert isinstance(message, kind)
        return
    assert refused.reason in (Reason.BAD_VALUE, Reason.UNKNOWN_COMMAND)


@pytest.mark.parametrize("kind", [MotionQuery, PoseQuery, CommandQuery])
@pytest.mark.parametrize(
    "wording",
    [
        Wording(b"", "", f"{LONG}=1"),
        Wording(b"", "", f"x&{LONG}"),
        Wording(b"", "", f"command={LONG};x={LONG};y=0;z=0;yaw={LONG}"),
        Wording(LONG.encode(), "", ""),
        Wording(b'{"' + LONG.encode() + b'":1}', "", ""),
    ],
)
def test_a_refusal_repeats_a_little_of_what_was_sent(
    wording: Wording, kind: type[MotionQuery | PoseQuery | CommandQuery]
) -> None:
    with pytest.raises(Refused) as refused:
        requests.read(wording, kind)
    assert len(refused.value.message) < 500


@given(FLOATS, FLOATS, FLOATS, st.booleans())
def test_all_wordings_of_a_motion_mean_the_same(x: float, y: float, z: float, absolute: bool) -> None:
    query = MotionQuery(absolute=absolute, position=Vector3(x, y, z))
    mode = "absolute" if absolute else "relative"
    wordings = [
        Wording(codec.encode(query), codec.MSGPACK, ""),
        Wording(codec.encode_json(query), "", ""),
        Wording(f"{x!r} {y!r} {z!r} {mode}".encode(), "", ""),
        Wording(b"", "", f"x={x!r};y={y!r};z={z!r};absolute={str(absolute).lower()}"),
    ]
    assert all(requests.read(wording, MotionQuery) == query for wording in wordings)


@given(st.recursive(st.none() | st.booleans() | st.floats() | st.text(), st.lists, max_leaves=5))
def test_any_msgpack_value_is_refused_unless_it_is_a_request(value: object) -> None:
    with pytest.raises(Refused):
        requests.read(Wording(msgpack.packb(value), codec.MSGPACK, ""), MotionQuery)


@pytest.mark.parametrize(
    ("payload", "encoding"),
    [(b'{"yaw":' + b"[" * 5000, ""), (b"\x81\xa3yaw" + b"\x91" * 5000, codec.MSGPACK)],
)
def test_thousands_of_brackets_are_refused(payload: bytes, encoding: str) -> None:
    with pytest.raises(Refused):
        requests.read(Wording(payload, encoding, ""), PoseQuery)
    with pytest.raises(Refused):
        requests.read_motion_or_pose(Wording(payload, encoding, ""))


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, 1e39])
def test_numbers_that_no_float32_holds_are_refused_by_name(number: float) -> None:
    query = {"position": {"x": 0.0, "y": number, "z": 0.0}}
    with pytest.raises(Refused, match=r"position\.y"):
        requests.read(Wording(msgpack.packb(query), codec.MSGPACK, ""), MotionQuery)


@pytest.mark.parametrize(
    ("parameters", "kind"),
    [("x=1;y=2;z=3", MotionQuery), ("yaw=1", PoseQuery), ("pitch=0.1;speed=1", PoseQuery)],
)
def test_a_preview_is_told_apart_by_its_fields(parameters: str, kind: type[MotionQuery | PoseQuery]) -> None:
    assert isinstance(requests.read_motion_or_pose(Wording(b"", "", parameters)), kind)


def test_plain_words_do_not_say_what_a_preview_means() -> None:
    with pytest.raises(Refused, match="do not say"):
        requests.read_motion_or_pose(Wording(b"1 2 3", "", ""))


def test_a_parameter_given_twice_is_refused() -> None:
    with pytest.raises(Refused, match="'command' is given twice"):
        requests.read(Wording(b"", "", "command=enable;command=stop"), CommandQuery)


def test_a_field_that_has_parts_is_no_parameter() -> None:
    with pytest.raises(Refused, match=r"'position' is no parameter: its parts x, y, z are\. Ask with words"):
        requests.read(Wording(b"", "", "position=1;x=0.1;y=0;z=0"), MotionQuery)


@pytest.mark.parametrize(
    ("wording", "told"),
    [
        (Wording(b"1 2 3", "", "absolute=false"), r"leave out the parameters 'absolute'\. Ask with words"),
        (Wording(b'{"position":{"x":1,"y":2,"z":3}}', "", "speed=0.1"), "leave out the parameters 'speed'"),
        (Wording(b"1 2 3 absolute relative", "", ""), "say absolute or relative, once"),
    ],
)
def test_what_is_said_in_two_ways_is_refused(wording: Wording, told: str) -> None:
    with pytest.raises(Refused, match=told):
        requests.read(wording, MotionQuery)


def test_parameters_of_zenoh_itself_go_with_a_payload() -> None:
    assert requests.read(Wording(b"1 2 3", "", "_time=[now(-1s)..]"), MotionQuery).absolute


@pytest.mark.parametrize(
    "wording", [Wording(b"disable on", "", ""), Wording(b"", "", "command=disable;value=true")]
)
def test_disable_takes_no_value(wording: Wording) -> None:
    with pytest.raises(Refused, match="disable takes no value"):
        requests.read(wording, CommandQuery)


def test_percent_codes_in_parameters_are_decoded() -> None:
    assert requests.read(Wording(b"", "", "command=enable;value=%6Fn"), CommandQuery).value


def test_an_answer_comes_in_kind() -> None:
    reply = Vector3(0.5, 0.0, 0.0)
    assert Wording(b"", codec.MSGPACK, "").answer(reply) == (codec.encode(reply), codec.MSGPACK)
    assert Wording(b"", "", "").answer(reply) == (b'{"x":0.5,"y":0.0,"z":0.0}', codec.JSON)


def test_unknown_fields_in_replies_are_for_later_versions() -> None:
    newer = msgpack.packb(
        {
            "result": True,
            "phase": "done",
            "reason": "OK",
            "message": "",
            "motion": 1,
            "duration": 1.0,
            "position": {"x": 0.0, "y": 0.0, "z": 0.0},
            "mood": "good",
        }
    )
    assert codec.decode(newer, MotionReply).result


def test_a_position_message_stays_small() -> None:
    vector = Vector3(0.1, 0.2, 0.3)
    from beatrix_zenoh._generated.messages import Head, Steps

    positions = Positions(
        seq=1,
        t_mono_ns=10**15,
        t_wall_ns=10**18,
        position=vector,
        velocity=vector,
        commanded=vector,
        steps=Steps(1, 2, 3),
        head=Head(0.1, 0.2, 0.3),
    )
    assert len(codec.encode(positions)) < 250
