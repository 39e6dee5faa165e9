"""Decoding of queries: any bytes give a message, or a refusal that names the field if one is wrong."""

from __future__ import annotations

import codecs
import contextlib
import math
import time

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import Refused
from beatrix_zenoh.bus import query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import (
    CommandQuery,
    MotionQuery,
    PoseQuery,
    Reason,
    Vector3,
)


def refusal_of(raw: RawQuery, kind: type[MotionQuery | PoseQuery | CommandQuery] | None) -> Refused:
    """Return the refusal of a query of this kind; None stands for a motion or a pose."""
    with pytest.raises(Refused) as caught:
        _ = query_forms.read_motion_or_pose(raw) if kind is None else query_forms.read(raw, kind)
    return caught.value


def field_of(refusal: Refused) -> str:
    assert refusal.detail is not None
    return refusal.detail.field


def test_a_byte_order_mark_before_a_text_changes_nothing() -> None:
    for text in (b'{"yaw":0.3}', b"0.3"):
        with contextlib.suppress(Refused):
            marked = RawQuery(codecs.BOM_UTF8 + text, "", "")
            assert query_forms.read(marked, PoseQuery) == query_forms.read(RawQuery(text, "", ""), PoseQuery)


KINDS = st.sampled_from([MotionQuery, PoseQuery, CommandQuery])
FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)


@given(
    st.builds(
        RawQuery,
        st.binary(max_size=200),
        st.sampled_from(["", "zenoh/bytes", codec.MSGPACK]),
        st.just("") | st.text(max_size=100),
    ),
    KINDS,
)
def test_any_query_is_decoded_or_refused(
    raw: RawQuery, kind: type[MotionQuery | PoseQuery | CommandQuery]
) -> None:
    try:
        message = query_forms.read(raw, kind)
    except Refused as error:
        refused = error
    else:
        assert isinstance(message, kind)
        return
    assert refused.reason in (Reason.BAD_VALUE, Reason.UNKNOWN_COMMAND)
    assert refused.message


@given(FLOATS, FLOATS, FLOATS, st.booleans())
def test_all_forms_of_a_motion_give_the_same_message(x: float, y: float, z: float, absolute: bool) -> None:
    query = MotionQuery(absolute=absolute, position=Vector3(x, y, z))
    raws = [
        RawQuery(codec.encode(query), codec.MSGPACK, ""),
        RawQuery(codec.encode_json(query), "", ""),
        RawQuery(b"", "", f"x={x!r};y={y!r};z={z!r};absolute={str(absolute).lower()}"),
    ]
    assert all(query_forms.read(raw, MotionQuery) == query for raw in raws)


def test_speeds_are_read_from_parameters() -> None:
    for text, speed in (
        ("x=1;y=2;z=3;absolute=false", None),
        ("x=1;y=2;z=3;speed=0.5", Vector3(0.5, 0.5, 0.5)),
        ("speed_z=.125;x=1;y=2;z=3;speed_x=.5;speed_y=.25", Vector3(0.5, 0.25, 0.125)),
    ):
        query = query_forms.read(RawQuery(b"", "", text), MotionQuery)
        assert query == MotionQuery(absolute=speed is not None, position=Vector3(1, 2, 3), speed=speed)


@pytest.mark.parametrize(
    "raw",
    [
        RawQuery(b'{"roll":0}', "", ""),
        RawQuery(codec.encode(PoseQuery()), codec.MSGPACK, ""),
        RawQuery(b"", "", "pitch=0"),
    ],
)
def test_the_home_pose_may_be_requested(raw: RawQuery) -> None:
    assert query_forms.read(raw, PoseQuery) == PoseQuery()


def test_an_unknown_command_is_refused_with_the_list_of_commands() -> None:
    wrong = refusal_of(RawQuery(b'{"command":"enabel"}', "", ""), CommandQuery)
    assert (wrong.reason, field_of(wrong)) == (Reason.BAD_VALUE, "command")
    refusal = refusal_of(RawQuery(b"", "", "command=enabel"), CommandQuery)
    assert (refusal.reason, field_of(refusal)) == (Reason.UNKNOWN_COMMAND, "enabel")
    assert refusal.detail is not None
    assert refusal.detail.known[0] == "1 ENABLE"


def in_text(text: bytes, parameters: str = "") -> RawQuery:
    """Return a query in text; its payload may be JSON."""
    return RawQuery(text, "", parameters)


@pytest.mark.parametrize(
    ("raw", "kind", "field"),
    [
        (in_text(b'{"speed":0.5}'), PoseQuery, "yaw"),
        (in_text(b"", "speed=0.5"), None, "yaw"),
        (RawQuery(msgpack.packb({}), codec.MSGPACK, ""), PoseQuery, "yaw"),
        (in_text(b"", "command=enable;command=stop"), CommandQuery, "command"),
        (in_text(b'{"position":{"x":1,"y":2,"z":3}}', "speed=0.1"), MotionQuery, "speed"),
        (in_text(b"", "x=1;y=2;z=3;speed=0.1;speed_x=0.1"), MotionQuery, "speed"),
        (in_text(b"", "x=1;y=2;z=3;speed_x=1"), MotionQuery, "speed.y"),
        (in_text(b'{"position":{"x":1,"y":1}}'), MotionQuery, "position.z"),
        (in_text(b'{"position":{"x":1,"y":1,"z":1,"w":1}}'), MotionQuery, "position.w"),
        (in_text(b'{"position":{"x":1,"y":null,"z":1}}'), MotionQuery, "position.y"),
        (in_text(b'{"position":[1,2,3]}'), MotionQuery, "position"),
        (in_text(b'{"absolute":true}'), MotionQuery, "position"),
        (in_text(b'{"position":{"x":1,"y":1e39,"z":1}}'), MotionQuery, "position.y"),
        *(
            (RawQuery(msgpack.packb({"position": {"x": 0.0, "y": number, "z": 0.0}}), codec.MSGPACK, ""), MotionQuery, "position.y")
            for number in (math.nan, math.inf, -math.inf, 1e39)
        ),
        *(
            (in_text(b"", f"yaw=1;pitch={text}"), PoseQuery, "pitch")
            for text in (".", "+", "1_0", "0x1", "nan", "inf", "1e999", "--5", "٣", "5..", "", "true")
        ),
    ],
)  # fmt: skip
def test_a_refusal_names_the_field(
    raw: RawQuery, kind: type[MotionQuery | PoseQuery | CommandQuery] | None, field: str
) -> None:
    refusal = refusal_of(raw, kind)
    assert (refusal.reason, field_of(refusal)) == (Reason.BAD_VALUE, field)


@pytest.mark.parametrize(
    "raw",
    [
        in_text(b"0 0 " + b"1" * 3000 + b"x"),
        in_text(b"", f"x={'1' * 3000}x;y=0;z=0"),
        in_text(b"0 0 " + b"1" * 100_000 + b"x"),
        in_text(b"", f"x={'1' * 100_000};y=0;z=0"),
        in_text(b"[" * 100_000),
        in_text(b'{"yaw":' + b"[" * 5000),
        RawQuery(b"\x81\xa3yaw" + b"\x91" * 5000, codec.MSGPACK, ""),
    ],
    ids=["words", "parameters", "long words", "long parameters", "brackets", "JSON", "msgpack"],
)
def test_a_long_request_is_refused_within_50_ms(raw: RawQuery) -> None:
    """Decoding holds the interpreter lock, which delays STOP and positions."""
    began_s = time.process_time()
    refusal = refusal_of(raw, MotionQuery)
    assert time.process_time() - began_s < 0.05
    assert len(refusal.message) < 600, "it repeats only the beginning of the request"
    refusal_of(raw, None)
