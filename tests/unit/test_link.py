"""Framing: the golden bytes of the contract, chunks of any size, invalid input."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.board.link import Decoder, SerialFrame, crc16, encode
from beatrix_zenoh.contract._generated.serial import MAX_ENCODED, MAX_PAYLOAD, FrameType

VECTORS = json.loads(
    (Path(__file__).resolve().parents[2] / "schemas/vectors/serial.json").read_text(encoding="utf-8")
)
BYTE = st.integers(0, 255)
FRAMES = st.builds(SerialFrame, BYTE, BYTE, st.binary(max_size=MAX_PAYLOAD))


def on_wire(frames: list[SerialFrame]) -> bytes:
    return b"".join(encode(*frame) for frame in frames)


def test_the_crc_has_the_check_value_of_the_catalogue() -> None:
    assert crc16(b"123456789") == 0x6F91  # check value of CRC-16/MCRF4XX


@pytest.mark.parametrize("vector", VECTORS, ids=lambda v: f"{v['frame']}-{v['seq']}")
def test_golden_frames_are_decoded_and_encoded(vector: dict[str, str]) -> None:
    wire = bytes.fromhex(vector["wire"])
    (frame,) = Decoder().feed(wire)
    assert (frame.type, frame.seq) == (FrameType[vector["frame"]], int(vector["seq"]))
    assert encode(*frame) == wire


@given(FRAMES)
def test_an_encoded_frame_contains_no_delimiter_and_does_not_begin_like_text(frame: SerialFrame) -> None:
    block = encode(*frame)[1:-1]
    assert 0 not in block
    assert len(block) <= MAX_ENCODED
    assert block[0] != ord("@")


@given(st.lists(FRAMES, max_size=5), st.lists(st.integers(0, 400), max_size=12))
def test_chunks_of_any_size_give_the_same_frames(frames: list[SerialFrame], cuts: list[int]) -> None:
    wire, decoder, got, at = on_wire(frames), Decoder(), [], 0
    for cut in [*sorted(cuts), len(wire)]:
        got += decoder.feed(wire[at:cut])
        at = max(at, cut)
    assert got == frames
    assert decoder.rejected == 0


@given(st.lists(st.binary(max_size=300), max_size=8), FRAMES)
def test_garbage_never_raises_and_the_next_frame_is_decoded(garbage: list[bytes], frame: SerialFrame) -> None:
    decoder = Decoder()
    for chunk in garbage:
        decoder.feed(chunk)
    assert decoder.feed(encode(*frame))[-1] == frame


@given(FRAMES, st.data())
def test_one_wrong_bit_is_detected(frame: SerialFrame, data: st.DataObject) -> None:
    wire = bytearray(encode(*frame))
    wire[data.draw(st.integers(1, len(wire) - 2))] ^= 1 << data.draw(st.integers(0, 7))
    decoder = Decoder()
    assert decoder.feed(bytes(wire)) == []
    assert decoder.rejected >= 1


@given(FRAMES, st.data())
def test_a_truncated_frame_is_rejected(frame: SerialFrame, data: st.DataObject) -> None:
    wire = encode(*frame)
    half = wire[: data.draw(st.integers(2, len(wire) - 2))]
    decoder = Decoder()
    assert decoder.feed(half) == []
    *before, last = decoder.feed(wire)
    assert last == frame
    # One of 256 truncated frames is a frame with a payload one byte shorter and a correct CRC (a property of CRCs
    # without a final xor); the check of the payload's length rejects it.
    assert [cut.payload for cut in before] in ([], [frame.payload[:-1]])
    assert len(before) + decoder.rejected == 1


@pytest.mark.parametrize(
    "block",
    [b"\x01", b"\x05\x01\x01\xe9", b"\x02\x41" * 40, b"\x05\x01\x01\xe9\xf9", b"\x03\x41\x42"],
    ids=["empty", "run too short", "too long", "wrong CRC", "too short"],
)
def test_an_invalid_block_is_counted_once(block: bytes) -> None:
    decoder = Decoder()
    assert decoder.feed(b"\0" + block + b"\0") == []
    assert decoder.rejected == 1


def test_endless_garbage_does_not_fill_memory() -> None:
    decoder = Decoder()
    for _ in range(100):
        decoder.feed(b"U" * 10_000)
    assert len(decoder._block) <= MAX_ENCODED + 1


def test_a_payload_that_is_too_long_raises_value_error() -> None:
    with pytest.raises(ValueError, match="57 bytes: a frame contains at most 56"):
        encode(1, 1, bytes(MAX_PAYLOAD + 1))
