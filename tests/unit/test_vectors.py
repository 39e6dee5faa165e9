"""Golden bytes: an independent encoder and ours write the same, and our decoder reads them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TypedDict, cast

import msgpack
import pytest
from msgspec import Struct, convert, defstruct, to_builtins
from msgspec.structs import replace
from robots import ROOT, untraced

from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract.errors import Refused

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


# -- several threads that decode the first messages of a process at the same time ------------------


PROGRAM = """
import json, sys, threading
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract.errors import Refused
sys.setswitchinterval(1e-6)
for vector in json.load(open("schemas/vectors/messages.json")):
    kind = getattr(messages, vector["message"])
    data = bytes.fromhex(vector["msgpack"])
    begin = threading.Barrier(8)
    def decode():
        begin.wait()
        assert isinstance(codec.decode(data, kind), kind)
    threads = [threading.Thread(target=decode) for _ in range(8)]
    for thread in threads: thread.start()
    for thread in threads: thread.join()
print("decoded")
"""


def test_threads_that_decode_a_message_for_the_first_time_do_not_crash() -> None:
    for _ in range(2):  # without the preparation, most of these processes ended by a segmentation fault
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM],
            capture_output=True,
            text=True,
            cwd=ROOT,
            env=untraced(),
            check=False,
            timeout=60.0,
        )
        assert (done.returncode, done.stdout, done.stderr) == (0, "decoded\n", "")


def test_an_older_robot_reads_requests_that_do_not_use_a_new_field() -> None:
    for entry in (one for one in ENTRIES if one["message"].endswith("Query")):
        kind = cast("type[Struct]", getattr(messages, entry["message"]))
        message = codec.decode(bytes.fromhex(entry["msgpack"]), kind)
        newer = defstruct("Newer", [("new", float, 0.5)], bases=(kind,), frozen=True, kw_only=True)
        request = convert(to_builtins(message), newer)
        assert codec.decode(codec.encode_request(request), kind) == message
        with pytest.raises(Refused, match="`new`"):
            codec.decode(codec.encode_request(replace(request, new=0.6)), kind)


def test_a_pose_straight_ahead_has_an_angle() -> None:
    assert msgpack.unpackb(codec.encode_request(messages.PoseQuery())) == {"yaw": 0.0}
