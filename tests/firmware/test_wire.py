"""Serial link of the virtual board: golden frames, damaged frames, noise, and the times of telemetry."""

from __future__ import annotations

import json
import random

import pytest
from firmware_host import ROOT, Rig, damaged
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    CONTRACT,
    BoardState,
    Error,
    FrameType,
    HelloReply,
    Move,
    MoveStraight,
)

VECTORS = json.loads((ROOT / "schemas/vectors/serial.json").read_text(encoding="utf-8"))
MOVE = encode(FrameType.MOVE, 7, Move(513, (100, -200, 300), (1400, 1400, 1400)).pack())
STRAIGHT = encode(FrameType.MOVE_STRAIGHT, 7, MoveStraight(513, (100, -200, 300), 1400).pack())


@pytest.mark.parametrize("vector", VECTORS, ids=lambda v: f"{v['frame']}-{v['seq']}")
def test_golden_frames_are_answered_with_their_seq(rig: Rig, vector: dict[str, str]) -> None:
    (reply,) = rig.raw(bytes.fromhex(vector["wire"]))
    assert (reply.type, reply.seq) == (FrameType[vector["frame"]] | 0x80, int(vector["seq"]))
    assert len(reply.payload) == (HelloReply.layout.size if vector["frame"] == "HELLO" else 1)


def test_hello_reply_contains_contract_version_boot_and_name() -> None:
    rig = Rig(Firmware(boot=0xDEADBEEF, name="bea-1"))
    (asked,) = rig.raw(encode(FrameType.HELLO, 5, b""))
    assert (asked.type, asked.seq) == (FrameType.HELLO_REPLY, 5)
    hello = HelloReply.unpack(asked.payload)
    assert (hello.contract, hello.boot, hello.name.rstrip(b"\0")) == (CONTRACT, 0xDEADBEEF, b"bea-1")


@pytest.mark.parametrize("move", [MOVE, STRAIGHT])
def test_none_of_3000_damaged_moves_is_executed(ready: Rig, move: bytes) -> None:
    chance, whole = random.Random(1), move.strip(b"\0")
    tried = 0
    while tried < 3000:
        data = damaged(move, chance)
        if whole in data.split(b"\0"):
            continue  # only the delimiters were damaged
        tried += 1
        # A delimiter that becomes 0x01 makes a frame one byte longer whose CRC is right (a property of CRCs without a
        # final xor): the length check rejects it. A `@` where a frame begins and a later line end make unknown text.
        replies = [reply.payload for reply in ready.raw(data + b"\0")]
        assert replies in ([], [bytes([Error.BAD_LENGTH])], [b"\x01NACK\n"])
        assert BoardState.MOVING not in ready.state
    ready.tick(50)
    assert ready.steps == (0, 0, 0)
    assert ready.last.motion == 0
    assert ready.last.rejected >= 2500
    assert ready.ask(FrameType.PING) == Error.OK


@settings(max_examples=60)
@given(st.lists(st.binary(max_size=400), max_size=6), st.integers(1, len(MOVE) - 2))
def test_noise_and_partial_frames_cause_no_step_and_the_next_frame_is_answered(
    noise: list[bytes], cut: int
) -> None:
    rig = Rig()
    for chunk in noise:
        rig.raw(chunk)
        rig.tick(20)
    rig.raw(b"\0" + MOVE[1:cut])
    rig.tick(20)
    assert rig.steps == (0, 0, 0)
    assert rig.ask(FrameType.PING) == Error.OK


@given(st.integers(0, 63), st.binary(max_size=56))
def test_every_request_is_answered_once(kind: int, payload: bytes) -> None:
    rig = Rig()
    (reply,) = rig.raw(encode(kind, 77, payload))
    assert (reply.type, reply.seq) == (kind | 0x80, 77)


@pytest.mark.parametrize("kind", [kind for kind in FrameType if kind < 0x80])
def test_a_payload_of_the_wrong_length_is_refused(rig: Rig, kind: FrameType) -> None:
    (reply,) = rig.raw(encode(kind, 1, bytes(17)))
    assert reply.payload == bytes([Error.BAD_LENGTH])


@pytest.mark.parametrize("kind", [FrameType.STOP, FrameType.EMERGENCY_STOP], ids=lambda kind: kind.name)
def test_a_stop_is_acknowledged_once_with_every_seq(rig: Rig, kind: FrameType) -> None:
    lines = b"@GETALLPOS\r" * 5
    for seq in range(256):
        replies = [frame for frame in rig.raw(lines + encode(kind, seq, b"")) if frame.type == kind | 0x80]
        assert [frame.seq for frame in replies] == [seq]
        rig.tick(10)


def test_a_reset_received_before_an_emergency_is_refused(rig: Rig) -> None:
    reset, stop = encode(FrameType.RESET, 1, b""), encode(FrameType.EMERGENCY_STOP, 2, b"")
    replies = rig.raw(reset + encode(FrameType.ENABLE, 3, b"\1") + stop)
    assert [frame.payload[0] for frame in replies] == [Error.EMERGENCY, Error.EMERGENCY, Error.OK]
    assert rig.state == BoardState.EMERGENCY
