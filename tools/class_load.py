"""Some robots or seats of a class under load, in one process; `bench_class_load.py` starts several.

`class_load.py robot KEY WHERE KEY WHERE ...` publishes positions of each KEY at 50 Hz until the end of its input.
`class_load.py seat KEY WHERE KEY WHERE ...` subscribes for each line `SECONDS` or `SECONDS KEY` of its input, each seat
to its own KEY or to that of the line, and prints the ages and the number of messages as JSON. WHERE is the file of an
account, or the endpoint of a router of bare Zenoh. With bare Zenoh messages have the same length, but no fields.

Seats store messages as they arrive and read them at the end, as a monitor does with what no person looks at.
"""

from __future__ import annotations

import json
import select
import struct
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Final

import zenoh

from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Head, Positions, Steps, Vector3
from beatrix_zenoh.contract.errors import Refused

SETTLE_S: Final = 1.0
"""Time (s) from a subscription to the first message that counts."""
Store = Callable[[str, bytes], None]
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

    def subscribe(self, key: str, store: Store) -> Callable[[], object]:
        """Pass key and payload of messages to `store`; return a function that ends the subscription."""
        return self._bus.subscribe(key, lambda received: store(received.key, received.payload))

    @staticmethod
    def read(payload: bytes) -> tuple[int, int]:
        """Return number and time (ns) of a message."""
        message = codec.decode(payload, Positions)
        return message.seq, message.t_mono_ns

    def close(self) -> None:
        """End the session."""
        self._bus.close()


class Bare:
    """A session of Zenoh without BEATRIX, except for its callbacks, which are three times as fast as Zenoh's own."""

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

    def subscribe(self, key: str, store: Store) -> Callable[[], object]:
        """Subscribe as `Ours.subscribe` does."""

        def receive(sample: zenoh.Sample) -> None:
            store(str(sample.key_expr), sample.payload.to_bytes())

        return self._session.declare_subscriber(key, direct(receive)).undeclare

    @staticmethod
    def read(payload: bytes) -> tuple[int, int]:
        """Return number and time (ns) of a message."""
        number, sent_ns = STAMP.unpack_from(payload)
        return number, sent_ns

    def close(self) -> None:
        """End the session."""
        self._session.close()


def robots(publishing: list[tuple[str, Ours | Bare]]) -> None:
    """Publish at 50 Hz for each robot, one after the other within each period, until the end of the input."""
    puts = [session.publish(key) for key, session in publishing]
    period_s = 1 / keys.positions.rate_hz / len(puts)
    number, due_s = 0, time.monotonic()
    print("ready", flush=True)
    while not select.select([sys.stdin], [], [], max(0.0, due_s - time.monotonic()))[0]:
        puts[number % len(puts)](number // len(puts) + 1)
        number += 1
        due_s += period_s


def seats(subscribing: list[tuple[str, Ours | Bare]]) -> None:
    """Subscribe for each line of the input; print ages (ms), numbers of messages sent and of robots seen as JSON."""
    print("ready", flush=True)
    for line in sys.stdin:
        seconds, *common = line.split()
        stored: list[list[tuple[str, bytes, int]]] = [[] for _ in subscribing]

        def store(key: str, payload: bytes, *, into: list[tuple[str, bytes, int]]) -> None:
            into.append((key, payload, time.monotonic_ns()))

        begin_ns = time.monotonic_ns() + round(SETTLE_S * 1e9)
        ends = [
            session.subscribe(common[0] if common else key, partial(store, into=into))
            for (key, session), into in zip(subscribing, stored, strict=True)
        ]
        time.sleep(SETTLE_S + float(seconds) + SETTLE_S)
        for end in ends:
            end()
        within = begin_ns, begin_ns + round(float(seconds) * 1e9)
        found = [
            summary(session.read, into, within)
            for (_, session), into in zip(subscribing, stored, strict=True)
        ]
        print(json.dumps(found), flush=True)


def summary(
    read: Callable[[bytes], tuple[int, int]], stored: list[tuple[str, bytes, int]], within: tuple[int, int]
) -> dict[str, object]:
    """Return the ages (ms) of messages sent within two times (ns), and how many were sent by how many robots."""
    ages: list[float] = []
    first: dict[str, int] = {}
    last: dict[str, int] = {}
    for key, payload, came_ns in stored:
        try:
            number, sent_ns = read(payload)
        except Refused:  # damaged, as happens on an overloaded computer: the message counts as lost
            continue
        if within[0] <= sent_ns < within[1]:
            ages.append(round((came_ns - sent_ns) / 1e6, 3))
            first.setdefault(key, number)
            last[key] = number
    sent = sum(last[robot] - first[robot] + 1 for robot in first)
    return {"ages_ms": ages, "sent": sent, "robots": len(first)}


def main() -> None:
    """Run robots or seats."""
    role, *pairs = sys.argv[1:]
    sessions = [
        (key, Bare(where) if where.startswith("tcp/") else Ours(where)) for key, where in batched(pairs)
    ]
    if role == "robot":
        robots(sessions)
    else:
        seats(sessions)
    for _, session in sessions:
        session.close()


def batched(words: list[str]) -> Iterator[tuple[str, str]]:
    """Yield the words in pairs."""
    return zip(words[::2], words[1::2], strict=True)


if __name__ == "__main__":
    main()
