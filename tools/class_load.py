"""One robot or one seat of a class under load, as a process; `bench_class_load.py` starts many.

`class_load.py robot WHERE KEY` publishes positions at 50 Hz until the end of its input.
`class_load.py seat WHERE` subscribes to KEY for each line `KEY SECONDS` of its input, and prints the ages and the
number of messages as JSON. WHERE is the file of an account, or the endpoint of a router of bare Zenoh. With bare Zenoh
messages have the same length, but no fields.
"""

from __future__ import annotations

import json
import select
import struct
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import zenoh
from zenoh.handlers import Callback

from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.keys import POSITIONS_HZ
from beatrix_zenoh.contract._generated.messages import Head, Positions, Steps, Vector3
from beatrix_zenoh.contract.errors import Refused

SETTLE_S: Final = 1.0
"""Time (s) from a subscription to the first message that counts."""
STAMP: Final = struct.Struct("<qq")
"""Number and time (ns) at the beginning of a bare message."""


def positions(number: int) -> bytes:
    """Return a message as robots publish it, with this sequence number and the present time."""
    arms, head = Vector3(0.1, 0.2, 0.3), Head(0.1, 0.2, 0.3)
    message = Positions(
        seq=number,
        t_mono_ns=time.monotonic_ns(),
        t_wall_ns=time.time_ns(),
        position=arms,
        velocity=arms,
        commanded=arms,
        steps=Steps(1, 2, 3),
        head=head,
    )
    return codec.encode(message)


class Ours:
    """A session with an account of a class."""

    def __init__(self, path: str) -> None:
        account = accounts.load(Path(path))
        self._bus = zbus.connect(account.connect, account=account)

    def publish(self, key: str) -> Callable[[int], None]:
        """Return a function that publishes one message."""
        publication, _ = self._bus.publication(key, codec.MSGPACK)
        return lambda number: publication.put(positions(number))

    def subscribe(self, key: str, handle: Callable[[str, int, int], None]) -> Callable[[], object]:
        """Pass key, number and time (ns) of messages to `handle`; return a function that ends the subscription."""

        def receive(received: zbus.Received) -> None:
            try:
                message = codec.decode(received.payload, Positions)
            except Refused:  # damaged, as happens on an overloaded computer: the message counts as lost
                return
            handle(received.key, message.seq, message.t_mono_ns)

        return self._bus.subscribe(key, receive)

    def close(self) -> None:
        """End the session."""
        self._bus.close()


class Bare:
    """A session of Zenoh without BEATRIX."""

    def __init__(self, endpoint: str) -> None:
        config = zenoh.Config()
        config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", json.dumps([endpoint]))
        config.insert_json5("scouting/multicast/enabled", "false")
        config.insert_json5("transport/shared_memory/enabled", "false")
        self._session = zenoh.open(config)
        self._rest = bytes(len(positions(0)) - STAMP.size)

    def publish(self, key: str) -> Callable[[int], None]:
        """Return a function that publishes one message, as `Ours.publish` does."""
        publisher = self._session.declare_publisher(key)
        return lambda number: publisher.put(STAMP.pack(number, time.monotonic_ns()) + self._rest)

    def subscribe(self, key: str, handle: Callable[[str, int, int], None]) -> Callable[[], object]:
        """Subscribe as `Ours.subscribe` does."""

        def receive(sample: zenoh.Sample) -> None:
            handle(str(sample.key_expr), *STAMP.unpack_from(sample.payload.to_bytes()))

        return self._session.declare_subscriber(key, Callback(receive, indirect=False)).undeclare

    def close(self) -> None:
        """End the session."""
        self._session.close()


def robot(session: Ours | Bare, key: str) -> None:
    """Publish at 50 Hz until the end of the input."""
    put = session.publish(key)
    number, due_s = 0, time.monotonic()
    print("ready", flush=True)
    while not select.select([sys.stdin], [], [], max(0.0, due_s - time.monotonic()))[0]:
        number += 1
        put(number)
        due_s += 1 / POSITIONS_HZ


def seat(session: Ours | Bare) -> None:
    """Subscribe for each line of the input; print ages (ms), number of messages sent, and number of robots as JSON."""
    print("ready", flush=True)
    for line in sys.stdin:
        key, seconds = line.split()
        ages: list[float] = []
        first: dict[str, int] = {}
        last: dict[str, int] = {}
        begin_ns = time.monotonic_ns() + round(SETTLE_S * 1e9)
        end_ns = begin_ns + round(float(seconds) * 1e9)

        def handle(
            key: str,
            number: int,
            sent_ns: int,
            ages: list[float] = ages,
            first: dict[str, int] = first,
            last: dict[str, int] = last,
            within: tuple[int, int] = (begin_ns, end_ns),
        ) -> None:
            if within[0] <= sent_ns < within[1]:
                ages.append(round((time.monotonic_ns() - sent_ns) / 1e6, 3))
                first.setdefault(key, number)
                last[key] = number

        end = session.subscribe(key, handle)
        time.sleep(SETTLE_S + float(seconds) + SETTLE_S)
        end()
        sent = sum(last[robot] - first[robot] + 1 for robot in first)
        print(json.dumps({"ages_ms": ages, "sent": sent, "robots": len(first)}), flush=True)


def main() -> None:
    """Run a robot or a seat."""
    role, where = sys.argv[1:3]
    session = Bare(where) if where.startswith("tcp/") else Ours(where)
    if role == "robot":
        robot(session, sys.argv[3])
    else:
        seat(session)
    session.close()


if __name__ == "__main__":
    main()
