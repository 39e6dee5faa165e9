"""Hostile and broken traffic at the port of a router, and a seat that floods a robot.

Both run as processes of their own. `python tools/hostile.py flood ROBOT` sends motions to a robot and publishes
positions with the account of BEATRIX_ACCOUNT until it is killed. `python tools/hostile.py attack HOST PORT FILE` keeps
silent connections open and sends random bytes, wrong frames, HTTP, and the bytes in FILE, which a client has sent
before, unchanged and changed, until the end of its input.
"""

from __future__ import annotations

import contextlib
import random
import socket
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Self

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import PoseQuery
from beatrix_zenoh.settings import resolve

KINDS: Final = ("random", "garbage frame", "truncated", "replayed", "mutated", "oversize", "http")
HALF_OPEN: Final = 150
"""Number of connections that stay open and send nothing."""
PAUSE_S: Final = 0.002
"""Pause between two attacks of one kind (s)."""
LONGEST: Final = 65535
"""Largest length that Zenoh's frames on TCP can announce: two bytes, little-endian."""


def frames(stream: bytes) -> list[bytes]:
    """Split the TCP stream of a client into Zenoh's frames."""
    found = []
    while len(stream) >= 2:
        end = 2 + int.from_bytes(stream[:2], "little")
        found.append(stream[:end])
        stream = stream[end:]
    return found


def payload(kind: str, recorded: bytes, dice: random.Random) -> bytes:
    """Return the bytes of one attack; `recorded` are bytes that a client has sent in an earlier session."""
    match kind:
        case "random":
            sent = dice.randbytes(dice.randrange(1, 2000))
        case "garbage frame":
            noise = dice.randbytes(dice.randrange(1, 200))
            sent = len(noise).to_bytes(2, "little") + noise
        case "truncated":
            sent = recorded[: dice.randrange(1, len(recorded))]
        case "mutated":
            changed = bytearray(recorded)
            for _ in range(dice.randrange(1, 8)):
                changed[dice.randrange(len(changed))] = dice.randrange(256)
            sent = bytes(changed)
        case "oversize":
            sent = (LONGEST.to_bytes(2, "little") + bytes(LONGEST)) * 8
        case "http":
            sent = b"GET / HTTP/1.1\r\nHost: router\r\n\r\n"
        case _:
            sent = recorded
    return sent


class Attack:
    """Threads that attack a router's port until `close`; `recorded` are bytes of an earlier session of a client."""

    def __init__(self, host: str, port: int, recorded: bytes) -> None:
        self.sent: Counter[str] = Counter()
        """number of attacks by kind"""
        self._address, self._recorded = (host, port), recorded
        self._over = threading.Event()
        self._half_open = list(self._silent_connections())
        self._threads = [
            threading.Thread(target=self._run, args=(kind, random.Random(number)))
            for number, kind in enumerate(KINDS)
        ]
        for thread in self._threads:
            thread.start()

    def _silent_connections(self) -> Iterator[socket.socket]:
        for _ in range(HALF_OPEN):
            self.sent["half-open"] += 1
            yield socket.create_connection(self._address, 5.0)

    def _run(self, kind: str, dice: random.Random) -> None:
        while not self._over.wait(PAUSE_S):
            with contextlib.suppress(OSError), socket.create_connection(self._address, 5.0) as connection:
                connection.settimeout(0.05)
                connection.sendall(payload(kind, self._recorded, dice))
                connection.recv(100)
            self.sent[kind] += 1

    def close(self) -> None:
        """End all attacks."""
        self._over.set()
        for thread in self._threads:
            thread.join()
        for connection in self._half_open:
            connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def flood(robot: str) -> None:
    """Send motions to a robot, and publish positions of the account's robot, as fast as Zenoh accepts them."""
    settings = resolve()
    key = keys.pose(robot, "hw", settings.who)
    payloads = [codec.encode(PoseQuery(yaw=yaw)) for yaw in (0.9, 1.0)]
    own = keys.positions(settings.robot, "sim")
    with zbus.connect(settings.connect, account=settings.account) as bus:
        print("ready", flush=True)
        waiting: list[zbus.Query] = []
        number = 0
        while True:
            waiting.append(bus.query(key, payloads[number % 2], codec.MSGPACK, timeout_s=5.0))
            bus.put(own, bytes(1000), codec.MSGPACK)
            number += 1
            if len(waiting) > 500:
                waiting.pop(0).close()
            if not bus.connected:  # the router has disconnected this client
                time.sleep(0.01)


def attack(host: str, port: str, recorded: str) -> None:
    """Attack a router's port until the end of the input, then print the number of attacks of each kind."""
    with Attack(host, int(port), Path(recorded).read_bytes()) as begun:
        print("ready", flush=True)
        sys.stdin.read()
    print(dict(begun.sent), flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "flood":
        flood(sys.argv[2])
    else:
        attack(*sys.argv[2:5])
