"""Encoders of golden bytes, written from the text of the contract.

They share no code with `beatrix_zenoh`, so that the vectors do not repeat an error of the library.
"""

from __future__ import annotations

import struct

from contract import Contract


def msgpack_int(value: int) -> bytes:
    if 0 <= value < 128 or -32 <= value < 0:
        return struct.pack("b" if value < 0 else "B", value)
    forms = (
        [(0xCC, "B"), (0xCD, "H"), (0xCE, "I"), (0xCF, "Q")]
        if value > 0
        else [(0xD0, "b"), (0xD1, "h"), (0xD2, "i"), (0xD3, "q")]
    )
    for lead, form in forms:
        try:
            return bytes([lead]) + struct.pack(">" + form, value)
        except struct.error:
            continue
    raise ValueError(value)


def msgpack(value: object) -> bytes:
    """Return a value in MessagePack; supports only the types of our messages, and packs floats in single precision."""
    match value:
        case None:
            return b"\xc0"
        case bool():
            return b"\xc3" if value else b"\xc2"
        case int():
            return msgpack_int(value)
        case float():
            return b"\xca" + struct.pack(">f", value)
        case str():
            data = value.encode()
            return (bytes([0xA0 | len(data)]) if len(data) < 32 else bytes([0xD9, len(data)])) + data
        case list() | dict():
            return msgpack_container(value)
    raise TypeError(type(value))


def msgpack_container(value: list[object] | dict[str, object]) -> bytes:
    lead, parts = (
        (0x90, list(value))
        if isinstance(value, list)
        else (0x80, [part for row in value.items() for part in row])
    )
    long = 0xDC if isinstance(value, list) else 0xDE
    head = bytes([lead | len(value)]) if len(value) < 16 else struct.pack(">BH", long, len(value))
    return head + b"".join(map(msgpack, parts))


def crc16(data: bytes) -> int:
    """Return the CRC-16/MCRF4XX, computed bit by bit."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def cobs(data: bytes) -> bytes:
    """Return the Consistent Overhead Byte Stuffing of fewer than 254 bytes, without delimiters."""
    return b"".join(bytes([len(run) + 1]) + run for run in data.split(b"\0"))


def payload(contract: Contract, frame: str, values: dict[str, object]) -> bytes:
    out = b""
    fields: list[dict[str, object]] = list(contract.serial["frame"][frame].get("fields", []))  # type: ignore[call-overload]
    for field in fields:
        value, kind = values[str(field["name"])], str(field["type"])
        if kind == "char":
            out += str(value).encode().ljust(int(str(field["count"])), b"\0")
            continue
        form = {"u8": "<B", "u16": "<H", "u32": "<I", "i16": "<h", "i32": "<i"}[kind]
        out += b"".join(struct.pack(form, one) for one in (value if isinstance(value, list) else [value]))
    return out
