"""Golden bytes: an independent encoder and ours write the same, and our decoder reads them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TypedDict, cast

import msgpack
import msgspec
import pytest
from msgspec import Struct
from statuses import AT_HOME

from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract._generated.messages import Vector3

VECTORS = Path(__file__).resolve().parents[2] / "schemas/vectors/messages.json"


class Vector(TypedDict):
    """One entry of the golden file."""

    message: str
    value: dict[str, object]
    msgpack: str


ENTRIES = cast("list[Vector]", json.loads(VECTORS.read_text(encoding="utf-8")))


@pytest.mark.parametrize("entry", ENTRIES, ids=[f"{n}-{entry['message']}" for n, entry in enumerate(ENTRIES)])
def test_the_codec_and_an_independent_encoder_write_the_golden_bytes(entry: Vector) -> None:
    assert cast("bytes", msgpack.packb(entry["value"], use_single_float=True)).hex() == entry["msgpack"]
    kind = cast("type[Struct]", getattr(messages, entry["message"]))
    message = codec.decode(bytes.fromhex(entry["msgpack"]), kind)
    assert codec.encode(message).hex() == entry["msgpack"]


def test_a_positions_message_is_shorter_than_250_bytes() -> None:
    vector = Vector3(0.1, 0.2, 0.3)
    positions = msgspec.structs.replace(
        AT_HOME, t_mono_ns=10**15, t_wall_ns=10**18, position=vector, velocity=vector, commanded=vector
    )
    assert len(codec.encode(positions)) < 250
