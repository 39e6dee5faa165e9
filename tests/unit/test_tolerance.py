"""Tolerant decoding of messages of other versions and of foreign programs."""

from __future__ import annotations

import logging
import typing
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from statuses import READY

from beatrix_zenoh.client.tolerance import ITEMS, Reporter, Undecodable, decode
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import (
    CommandReply,
    Event,
    Events,
    Fault,
    Info,
    LeaseReply,
    MotionReply,
    Name,
    Positions,
    Reason,
    Status,
)
from beatrix_zenoh.printable import longest


def changed(**fields: object) -> bytes:
    """Return an encoded status in which these fields are changed, or missing if the value is None."""
    status = msgspec.to_builtins(READY) | fields
    return msgspec.msgpack.encode({name: value for name, value in status.items() if value is not None})


def test_a_message_of_this_version_is_read_as_it_is() -> None:
    assert decode(codec.encode(READY), Status) == (READY, "")


def test_new_fields_are_ignored() -> None:
    assert decode(changed(mood="cheerful"), Status) == (READY, "")


def test_an_unknown_enum_name_is_kept_and_equals_no_member() -> None:
    status, wrong = decode(changed(fault="OVERHEATED"), Status)
    assert (str(status.fault), f"{status.fault}") == ("OVERHEATED", "OVERHEATED")
    assert status.fault not in set(Fault)
    assert isinstance(status.fault, Fault)
    assert "fault 'OVERHEATED'" in wrong
    assert msgspec.json.decode(codec.encode_json(status))["fault"] == "OVERHEATED"
    assert msgspec.structs.replace(status, fault=Fault.NONE) == READY


@pytest.mark.parametrize(
    ("fields", "name", "value", "named"),
    [
        ({"calibrations": None}, "calibrations", 0, "no calibrations"),
        ({"warnings": None}, "warnings", [], "no warnings"),
        ({"holder": 7}, "holder", "", "unreadable holder"),
        ({"warnings": ["hot", 3]}, "warnings", ["hot", ""], "unreadable warnings"),
        ({"plant": "round"}, "plant", None, "unreadable plant"),
        ({"fault": None}, "fault", "UNKNOWN", "no fault"),
    ],
)
def test_a_missing_or_unreadable_field_gets_a_zero_value(
    fields: dict[str, object], name: str, value: object, named: str
) -> None:
    status, wrong = decode(changed(**fields), Status)
    assert getattr(status, name) == value
    assert named in wrong
    assert status.robot == "bea"


def test_fields_of_parts_are_named_with_their_path() -> None:
    board: dict[str, Any] = msgspec.to_builtins(READY.board)
    del board["boot"]
    status, wrong = decode(changed(board=board), Status)
    assert (status.board.boot, status.board.name) == (0, "bea")
    assert "no board.boot" in wrong


def test_an_invalid_number_counts_as_unreadable() -> None:
    reply = {
        "result": True,
        "reason": "OK",
        "message": "",
        "position": {"x": float("nan"), "y": 1.0, "z": 2.0},
    }
    read, wrong = decode(msgspec.msgpack.encode(reply), CommandReply)
    assert (read.position.x, read.position.y) == (0.0, 1.0)
    assert "unreadable position.x" in wrong


def test_a_reply_without_a_result_counts_as_failed() -> None:
    reply, _ = decode(msgspec.msgpack.encode({"motion": 3}), MotionReply)
    assert (reply.result, reply.motion, reply.reason in set(Reason)) == (False, 3, False)


@pytest.mark.parametrize(
    "data", [b"", b"hello", b"\xc1", b"\x93\x01\x02\x03", b"\x80", b"\x81\xa1a\x01", b"[" * 5000]
)
def test_bytes_without_a_field_of_the_message_are_undecodable(data: bytes) -> None:
    for kind in (Status, Positions, CommandReply):
        with pytest.raises(Undecodable):
            decode(data, kind)


def test_each_sender_is_reported_once(caplog: pytest.LogCaptureFixture) -> None:
    reporter = Reporter()
    with caplog.at_level(logging.WARNING, "beatrix_zenoh.client"):
        for _ in range(3):
            reporter.report("f00", "beatrix/bea/hw/stop", "ignored")
        reporter.report("f00", "beatrix/bea/hw/info", "ignored")
        reporter.report("", "beatrix/bea/hw/stop", "ignored")
    assert [record.getMessage() for record in caplog.records] == [
        "beatrix/bea/hw/stop from session f00: ignored",
        "beatrix/bea/hw/stop: ignored",
    ]


def test_the_number_of_reported_senders_is_bounded() -> None:
    reporter = Reporter()
    for number in range(5000):
        reporter.report(str(number), "beatrix/bea/hw/stop", "ignored")
    assert len(reporter._reported) == 1000


# -- text -----------------------------------------------------------------------------------------

SHOWN = (Status, Event, Events, Info, LeaseReply, MotionReply)
"""Messages whose text tables, window, page and recording show."""
UGLY = ("a\nbea2   hw   frozen", "\x1b[2J", "\x9b31m", "\u202egnp.exe", "\u2028", "\t")
TEXT = st.text(max_size=40) | st.sampled_from(UGLY) | st.integers(30, 20_000).map(lambda length: "é" * length)


def forged(kind: object) -> st.SearchStrategy[object]:
    """Return values of a type, encoded by a foreign program, whose text fields contain any text."""
    inner = typing.get_origin(kind)
    args: tuple[object, ...] = typing.get_args(kind)
    if inner is typing.Annotated:
        return forged(args[0])
    if kind is str or (isinstance(kind, type) and issubclass(kind, Fault | Reason)):
        return TEXT
    if inner is list:
        return st.lists(forged(args[0]), max_size=3) | forged(args[0]).map(lambda one: [one] * 300)
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        fields = {field.encode_name: forged(field.type) for field in msgspec.structs.fields(kind)}
        return st.fixed_dictionaries({}, optional=fields).filter(bool)
    if args:  # optional
        return forged(args[0])
    return st.sampled_from([0, 1, 0.5, True, None, "on\n"])


def texts(value: object) -> list[str]:
    """Return all texts in a decoded message; raises AssertionError for a list of texts that is too long."""
    if isinstance(value, str):
        return [str(value)]
    if isinstance(value, list):
        found = [text for one in value for text in texts(one)]
        assert len(value) <= ITEMS or not found
        return found
    if isinstance(value, msgspec.Struct):
        return [text for field in value.__struct_fields__ for text in texts(getattr(value, field))]
    return []


@given(st.sampled_from(SHOWN).flatmap(lambda kind: st.tuples(st.just(kind), forged(kind))))
def test_no_text_of_a_message_contains_a_control_character_or_is_too_long(
    sent: tuple[type[msgspec.Struct], object],
) -> None:
    kind, fields = sent
    message, wrong = decode(msgspec.msgpack.encode(fields), kind)
    for text in (*texts(message), wrong):
        assert text.isprintable()
        assert len(text) <= 1000 or text == wrong
    assert len(wrong) < 2000


@given(st.binary(max_size=200))
def test_no_bytes_become_text_with_a_control_character(data: bytes) -> None:
    for kind in SHOWN:
        try:
            message, wrong = decode(data, kind)
        except Undecodable:
            continue
        assert all(text.isprintable() for text in (*texts(message), wrong))


def test_a_name_keeps_its_alphabet_and_length_and_a_sentence_its_line() -> None:
    forged_holder = "-\nbea1   hw   ready ...\nbea2   hw   frozen"
    status, wrong = decode(changed(holder=forged_holder, warnings=["Hot.\nCold.\x1b[2J"]), Status)
    assert (status.holder, status.warnings, wrong) == (
        "-?bea1???hw???ready?????bea2???h",
        ["Hot. Cold.?[2J"],
        "",
    )
    status, _ = decode(changed(waiting=["x" * 900_000], warnings=["y" * 900_000]), Status)
    assert status.waiting == ["x" * longest(Name)]
    assert [len(text) for text in status.warnings] == [1000]


def test_a_report_about_a_key_is_one_line(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "beatrix_zenoh.client"):
        Reporter().report("f00", "beatrix/bea/hw/\nWARNING forged", "ignored")
    assert [record.getMessage() for record in caplog.records] == [
        "beatrix/bea/hw/ WARNING forged from session f00: ignored"
    ]
