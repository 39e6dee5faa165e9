"""Framing of the serial link: frames to bytes and back. No I/O."""

from __future__ import annotations

import binascii
from typing import Final, NamedTuple

from beatrix_zenoh.contract._generated.serial import MAX_ENCODED, MAX_PAYLOAD

_CRC_SIZE: Final = 2
_SHORTEST: Final = 2 + _CRC_SIZE
"""Size of type, seq and CRC (bytes)."""


class SerialFrame(NamedTuple):
    """A decoded frame whose CRC was correct."""

    type: int
    """0 to 255; a FrameType if known"""
    seq: int
    """0 to 255; a reply has the seq of its request"""
    payload: bytes
    """at most MAX_PAYLOAD bytes"""


_REVERSED: Final = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
"""Every byte with its bits in reverse order."""


def crc16(data: bytes | bytearray) -> int:
    """Return the CRC-16/MCRF4XX of `data`: polynomial 0x1021 reflected, start 0xFFFF, no final xor."""
    # Python has the same CRC for bits in the other order, and computes it 50 times as fast as a loop would.
    high, low = divmod(binascii.crc_hqx(data.translate(_REVERSED), 0xFFFF), 256)
    return _REVERSED[low] << 8 | _REVERSED[high]


def encode(type: int, seq: int, payload: bytes) -> bytes:  # noqa: A002 - the contract's word
    """Return the bytes of one frame with its delimiters: 0x00, COBS(type, seq, payload, CRC), 0x00.

    The leading delimiter separates the frame from earlier noise. `type` and `seq` are 0 to 255.
    Raises ValueError if the payload is longer than MAX_PAYLOAD bytes.
    """
    if len(payload) > MAX_PAYLOAD:
        raise ValueError(f"payload of {len(payload)} bytes: a frame contains at most {MAX_PAYLOAD}")
    body = bytes((type, seq)) + payload
    body += crc16(body).to_bytes(_CRC_SIZE, "little")
    # Consistent Overhead Byte Stuffing (Cheshire and Baker 1999); runs stay under 254 bytes here.
    stuffed = b"".join(bytes((len(run) + 1,)) + run for run in body.split(b"\0"))
    return b"\0" + stuffed + b"\0"


class Decoder:
    """Decoder of a byte stream in chunks of any size; it drops invalid blocks and counts them in `rejected`."""

    def __init__(self) -> None:
        self.rejected = 0
        """Invalid blocks: wrong CRC, length or stuffing."""
        self._block = bytearray()

    def feed(self, data: bytes) -> list[SerialFrame]:
        """Return the frames completed by `data`, in order of arrival."""
        frames = []
        *ended, rest = data.split(b"\0")
        for part in ended:
            if part:
                self._keep(part)
            if self._block:
                frame = _decode(bytes(self._block))
                if frame is None:
                    self.rejected += 1
                else:
                    frames.append(frame)
                self._block.clear()
        self._keep(rest)
        return frames

    def _keep(self, part: bytes) -> None:
        """Append to the block at most one byte more than allowed; this byte shows that the block is too long."""
        self._block += part[: MAX_ENCODED + 1 - len(self._block)]


def _decode(block: bytes) -> SerialFrame | None:
    size = len(block)
    if size > MAX_ENCODED:
        return None
    body = bytearray(block)
    at = 0
    while at < size:
        body[at] = 0
        at += block[at]
    if at != size:
        return None
    del body[0]
    if not _SHORTEST <= len(body) <= _SHORTEST + MAX_PAYLOAD:
        return None
    if crc16(body):  # the CRC of bytes that end with their own CRC is 0
        return None
    return SerialFrame(body[0], body[1], bytes(body[2:-_CRC_SIZE]))
