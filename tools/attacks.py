"""The attacks of `bench_attack.py`, each with the card of a pupil: `python tools/attacks.py NAME FILE PORT SECONDS`.

FILE holds the account, PORT is that of the class; the number of times that it was done is printed.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import msgspec
import zenoh

from beatrix_zenoh import BeatrixError
from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.classroom import certificates

Attack = Callable[[zenoh.Session, float], int]
"""Does something until a time (monotonic clock, s); returns how often."""
IGNORE: Final[zenoh.handlers.Callback[object]] = direct(lambda _: None)
"""A callback without a thread of its own."""


def repeated(once: Callable[[zenoh.Session, int], object], pause_s: float = 0.0) -> Attack:
    """Return an attack that repeats an action with a number."""

    def attack(session: zenoh.Session, end_s: float) -> int:
        for number in itertools.count():
            if time.monotonic() > end_s:
                return number
            with contextlib.suppress(zenoh.ZError):
                once(session, number)
            time.sleep(pause_s)
        return 0

    return attack


def tokens(session: zenoh.Session, end_s: float) -> int:
    """Declare 8 000 tokens, and end them, again and again."""
    count = 0
    while time.monotonic() < end_s:
        with contextlib.suppress(zenoh.ZError):
            kept = [session.liveliness().declare_token(f"beatrix/@seat/dan/y{i}") for i in range(8000)]
            count += len(kept)
            del kept
    return count


def subscribers(session: zenoh.Session, end_s: float) -> int:
    """Subscribe to the positions of all robots with 2 000 key expressions, and end it, again and again."""
    count = 0
    while time.monotonic() < end_s:
        with contextlib.suppress(zenoh.ZError):
            kept = [session.declare_subscriber(f"beatrix/*/hw/state/p$*{i}$*", IGNORE) for i in range(2000)]
            count += len(kept)
            del kept
    return count


def unanswered(session: zenoh.Session, end_s: float) -> int:
    """Serve an own key without an answer, and query it."""
    served = session.declare_queryable("beatrix/cem/sim/info", IGNORE)
    waiting: list[object] = []
    count = repeated(lambda s, _: waiting.append(s.get("beatrix/cem/sim/info", timeout=10)), 0.01)(
        session, end_s
    )
    del served
    return count


def sleepers(session: zenoh.Session, end_s: float) -> int:
    """Let twelve programs subscribe to everything and be suspended, and publish pictures that they do not read."""
    command = [sys.executable, __file__, "subscribe", sys.argv[2], sys.argv[3], "600"]
    programs = [subprocess.Popen(command) for _ in range(12)]
    time.sleep(3.0)
    for program in programs:
        program.send_signal(signal.SIGSTOP)
    try:
        picture = bytes(30_000)
        return repeated(lambda s, _: s.put("beatrix/cem/hw/state/camera/left", picture), 0.02)(session, end_s)
    finally:
        for program in programs:
            program.kill()
            program.wait()


def subscribe(session: zenoh.Session, end_s: float) -> int:
    """Subscribe to everything that a seat may."""
    kept = [session.declare_subscriber("beatrix" + "/*" * n, IGNORE) for n in range(1, 9)]
    time.sleep(max(0.0, end_s - time.monotonic()))
    return len(kept)


def sessions(_: zenoh.Session, end_s: float) -> int:
    """Open 500 sessions, and keep them."""
    account = accounts.load(Path(sys.argv[2]))
    kept: list[zbus.Bus] = []
    while time.monotonic() < end_s:
        with contextlib.suppress(BeatrixError):
            if len(kept) < 500:
                kept.append(zbus.connect(account.connect, account=account))
        time.sleep(0.01)
    return len(kept)


def former(_: zenoh.Session, end_s: float) -> int:
    """Make the longest declarations with a card that was replaced; returns how many sessions it opened."""
    account = accounts.load(Path(sys.argv[2]))
    old = certificates.account("cem.01234567", account.authority)
    account = msgspec.structs.replace(account, certificate=old.certificate, key=old.key)
    opened = 0
    while time.monotonic() < end_s:
        with contextlib.suppress(BeatrixError), zbus.connect(account.connect, account=account) as bus:
            opened += 1
            bus.use(lambda session: session.declare_subscriber("x" + "/a" * 30_000, IGNORE))
        time.sleep(0.5)
    return opened


def declare(length: int, key: str = "x") -> Attack:
    """Return an attack that declares a long key in a new session, every five seconds."""

    def attack(_: zenoh.Session, end_s: float) -> int:
        count, account = 0, accounts.load(Path(sys.argv[2]))
        while time.monotonic() < end_s:
            with contextlib.suppress(BeatrixError, zenoh.ZError):
                with zbus.connect(account.connect, account=account) as bus:
                    bus.use(lambda session: session.declare_subscriber(key + "/a" * length, IGNORE))
                    time.sleep(0.5)
                count += 1
            time.sleep(4.5)
        return count

    return attack


def stars(key: str, put: str) -> Attack:
    """Return an attack that makes the router compare a chunk of many `$*` with a long one, each half second."""

    def attack(session: zenoh.Session, end_s: float) -> int:
        account = accounts.load(Path(sys.argv[2]))
        others = [zbus.connect(account.connect, account=account) for _ in range(2)]
        kept = [session.declare_subscriber(key, IGNORE)]
        time.sleep(0.5)
        others[0].use(lambda other: other.put(put, b""))

        def one_more(session: zenoh.Session) -> None:
            kept.append(session.declare_subscriber(f"beatrix/*/hw/state/x{len(kept)}", IGNORE))

        while time.monotonic() < end_s:
            with contextlib.suppress(BeatrixError, zenoh.ZError):
                others[1].use(one_more)
            time.sleep(0.5)
        return len(kept)

    return attack


def long_chunks(session: zenoh.Session, end_s: float) -> int:
    """Subscribe to 1 000 keys with a chunk of 40 kB, and keep them."""
    kept = []
    for number in range(1000):
        with contextlib.suppress(zenoh.ZError):
            kept.append(session.declare_subscriber(f"beatrix/*/*/{number:06d}{'x' * 40_000}", IGNORE))
    time.sleep(max(0.0, end_s - time.monotonic()))
    return len(kept)


def stranger(_: zenoh.Session, end_s: float) -> int:
    """Send nonsense to the router of the seats without a certificate, 20 connections a second."""

    def once(_session: zenoh.Session, _number: int) -> None:
        with (
            contextlib.suppress(OSError),
            socket.create_connection(("127.0.0.1", int(sys.argv[3]) + 1), 0.05) as connection,
        ):
            connection.sendall(os.urandom(60))

    return repeated(once, 0.05)(_, end_s)


def nothing(_: zenoh.Session, end_s: float) -> int:
    """Wait."""
    time.sleep(max(0.0, end_s - time.monotonic()))
    return 0


def put_large(session: zenoh.Session, number: int) -> None:
    """Publish 0.9 MB, or 3.6 MB, which the router drops, with an attachment."""
    session.put(
        "beatrix/cem/hw/state/camera/left", bytes(900_000 * (1 + 3 * (number % 2))), attachment=bytes(50_000)
    )


def put_fake(session: zenoh.Session, number: int) -> None:
    """Publish a status of the own robot that cannot be decoded, with control characters."""
    session.put("beatrix/cem/hw/state/status", b"\x1b[2J\x00" * 1000 + str(number).encode())


ATTACKS: Final[dict[str, Attack]] = {
    "none": nothing,
    "STOP of another seat's robot": repeated(lambda s, _: s.put("beatrix/bea2/hw/stop/cem", b""), 0.002),
    "lease queries": repeated(lambda s, _: s.get("beatrix/bea1/hw/cmd/cem/lease", timeout=1), 0.005),
    "large puts": repeated(put_large, 0.1),
    "12 suspended subscribers, pictures": sleepers,
    "500 sessions": sessions,
    "tokens": tokens,
    "subscribers": subscribers,
    "unanswered queries": unanswered,
    "reads of all states": repeated(lambda s, _: list(s.get("beatrix/*/*/state/*", timeout=1)), 0.01),
    "fake robot": repeated(put_fake, 0.0015),
    "keys of 900 chunks": repeated(
        lambda s, n: s.declare_publisher(f"beatrix/cem/x{n}" + "/a" * 900).undeclare(), 0.1
    ),
    "keys of 8 000 chunks": declare(8000),
    "keys of 30 000 chunks": declare(30_000),
    "eleven $* in a chunk": stars(
        "beatrix/*/" + "$*a" * 11 + "$*b/state/status", f"beatrix/cem/{'a' * 33}/state/status"
    ),
    "twelve $* in a chunk": stars("beatrix/*/*/*/" + "$*a" * 12 + "$*b", f"beatrix/cem/hw/state/{'a' * 33}"),
    "chunks of 40 kB": long_chunks,
    "a replaced card": former,
    "a stranger": stranger,
    "none again": nothing,
}
OTHERS: Final[dict[str, Attack]] = {"subscribe": subscribe}


def connected(account: Account, end_s: float) -> zbus.Bus:
    """Connect; try until a time (monotonic clock, s), because the router may be started again after the attack before."""
    while True:
        try:
            return zbus.connect(account.connect, account=account)
        except BeatrixError:
            if time.monotonic() > end_s:
                raise
        time.sleep(0.5)


def attack(name: str, file: Path, seconds: float) -> int:
    """Run one attack; print how often."""
    end_s = time.monotonic() + seconds
    with connected(accounts.load(file), end_s) as bus:
        count = bus.use(lambda session: {**ATTACKS, **OTHERS}[name](session, end_s))
    print(count, flush=True)
    os._exit(0)  # sessions that the router has closed need no farewell


if __name__ == "__main__":
    attack(sys.argv[1], Path(sys.argv[2]), float(sys.argv[4]))
