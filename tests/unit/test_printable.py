"""Text of replies and publications, which any program may send, and messages that no program can read."""

from __future__ import annotations

import logging
import typing
from enum import StrEnum

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statuses import READY

from beatrix_zenoh.client.session import Reporter
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import (
    Event,
    Events,
    Info,
    LeaseReply,
    MotionReply,
    Name,
    Reason,
    Status,
)
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.printable import ITEMS, longest


def changed(**fields: object) -> bytes:
    """Return an encoded status in which these fields are changed, or missing if the value is None."""
    status = msgspec.to_builtins(READY) | fields
    return msgspec.msgpack.encode({name: value for name, value in status.items() if value is not None})


def test_new_fields_are_ignored() -> None:
    assert codec.decode(changed(mood="cheerful"), Status) == READY


@pytest.mark.parametrize(
    ("data", "field"),
    [
        (changed(fault="OVERHEATED"), "fault"),
        (changed(calibrations=None), "calibrations"),
        (changed(holder=7), "holder"),
        (b"", ""),
        (b"hello", ""),
        (b"\xc1", ""),
        (b"\x93\x01\x02\x03", ""),
        (b"[" * 5000, ""),
    ],
)
def test_a_message_of_another_version_is_refused_by_the_name_of_its_field(data: bytes, field: str) -> None:
    with pytest.raises(Refused) as refusal:
        codec.decode(data, Status)
    assert refusal.value.detail is not None
    assert (refusal.value.reason, refusal.value.detail.field) == (Reason.BAD_VALUE, field)


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


# -- text -----------------------------------------------------------------------------------------

SHOWN = (Status, Event, Events, Info, LeaseReply, MotionReply)
"""Messages whose text tables, window, page and recording show."""
UGLY = ("a\nbea2   hw   frozen", "\x1b[2J", "\x9b31m", "\u202egnp.exe", "\u2028", "\t")
TEXT = st.text(max_size=40) | st.sampled_from(UGLY) | st.integers(30, 20_000).map(lambda length: "é" * length)


def forged(kind: object) -> st.SearchStrategy[object]:
    """Return values of a type, encoded by a foreign program, whose text fields contain any text."""
    inner = typing.get_origin(kind)
    args: tuple[object, ...] = typing.get_args(kind)
    if inner is list:
        return st.lists(forged(args[0]), max_size=1) | forged(args[0]).map(lambda one: [one] * 300)
    if args:  # annotated or optional
        return forged(args[0])
    assert isinstance(kind, type)
    if issubclass(kind, msgspec.Struct):
        return st.fixed_dictionaries(
            {field.encode_name: forged(field.type) for field in msgspec.structs.fields(kind)}
        )
    if issubclass(kind, StrEnum):
        return st.sampled_from([*kind])
    values: dict[type, st.SearchStrategy[object]] = {
        str: TEXT,
        bool: st.booleans(),
        int: st.just(1),
        float: st.just(0.5),
    }
    return values[kind]


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


@settings(max_examples=12)
@given(st.sampled_from(SHOWN).flatmap(lambda kind: st.tuples(st.just(kind), forged(kind))))
def test_no_text_of_a_message_contains_a_control_character_or_is_too_long(
    sent: tuple[type[msgspec.Struct], object],
) -> None:
    kind, fields = sent
    for text in texts(codec.decode(msgspec.msgpack.encode(fields), kind)):
        assert text.isprintable()
        assert len(text) <= 1000


def test_a_name_keeps_its_alphabet_and_length_and_a_sentence_its_line() -> None:
    forged_holder = "-\nbea1   hw   ready ...\nbea2   hw   frozen"
    status = codec.decode(changed(holder=forged_holder, warnings=["Hot.\nCold.\x1b[2J"]), Status)
    assert (status.holder, status.warnings) == ("-?bea1???hw???ready?????bea2???h", ["Hot. Cold.?[2J"])
    status = codec.decode(changed(waiting=["x" * 900_000], warnings=["y" * 900_000]), Status)
    assert status.waiting == ["x" * longest(Name)]
    assert [len(text) for text in status.warnings] == [1000]
