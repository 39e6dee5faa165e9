"""Golden bytes: a foreign client's encoder and ours write them, and ours reads them back."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TypedDict, cast

import msgpack
import pytest
from msgspec import Struct

from beatrix_zenoh import codec
from beatrix_zenoh._generated import messages

VECTORS = Path(__file__).resolve().parents[2] / "schemas/vectors/messages.json"


class Vector(TypedDict):
    """One entry of the golden file."""

    message: str
    value: dict[str, object]
    msgpack: str


ENTRIES = cast("list[Vector]", json.loads(VECTORS.read_text(encoding="utf-8")))
every_entry = pytest.mark.parametrize(
    "entry", ENTRIES, ids=[f"{n}-{entry['message']}" for n, entry in enumerate(ENTRIES)]
)


@every_entry
def test_foreign_client_writes_the_golden_bytes(entry: Vector) -> None:
    written = cast("bytes", msgpack.packb(entry["value"], use_single_float=True))
    assert written.hex() == entry["msgpack"]


@every_entry
def test_codec_reads_the_golden_bytes_and_writes_them_again(entry: Vector) -> None:
    kind = cast("type[Struct]", getattr(messages, entry["message"]))
    message = codec.decode(bytes.fromhex(entry["msgpack"]), kind)
    assert codec.encode(message).hex() == entry["msgpack"]
