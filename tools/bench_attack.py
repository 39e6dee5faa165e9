"""Attacks on a class with a pupil's card: `python tools/bench_attack.py [SECONDS]` prints a table, a row for each attack.

A router of a class, two virtual robots, the teacher who presses STOP five times a second, a pupil who moves a robot, and
one attack after the other for SECONDS each (default 80: half an hour), all in real processes on loopback.
`python tools/bench_attack.py SECONDS NAME ...` makes only these attacks.
`python tools/bench_attack.py attack NAME FILE PORT SECONDS` is one attack, with the account in FILE.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import msgspec
import zenoh

from beatrix_zenoh import BeatrixError, Robot
from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.classroom import certificates, class_file, provision
from beatrix_zenoh.client import Client
from beatrix_zenoh.recording.viewer import free_port
from beatrix_zenoh.settings import Settings

CLASS: Final = """
name = "attacked"
addresses = ["127.0.0.1"]
seats = ["ana", "cem", "dan"]
robots = ["bea1", "bea2"]
[router]
port = {port}
"""
ROBOTS: Final = ("bea1", "bea2")
STOP_S: Final = 0.2
PATIENCE_S: Final = 10.0
IGNORE: Final[zenoh.handlers.Callback[object]] = direct(lambda _: None)
"""A callback without a thread of its own."""
Attack = Callable[[zenoh.Session, float], int]
"""Does something until a time (monotonic clock, s); returns how often."""


# -- the attacks: a session with the card of `cem`, or of `dan` for tokens ------------------------


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
    command = [sys.executable, __file__, "attack", "subscribe", sys.argv[3], sys.argv[4], "600"]
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
    account = accounts.load(Path(sys.argv[3]))
    kept: list[zbus.Bus] = []
    while time.monotonic() < end_s:
        with contextlib.suppress(BeatrixError):
            if len(kept) < 500:
                kept.append(zbus.connect(account.connect, account=account))
        time.sleep(0.01)
    return len(kept)


def former(_: zenoh.Session, end_s: float) -> int:
    """Make the longest declarations with a card that was replaced; returns how many sessions it opened."""
    account = accounts.load(Path(sys.argv[3]))
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
        count, account = 0, accounts.load(Path(sys.argv[3]))
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
        account = accounts.load(Path(sys.argv[3]))
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
            socket.create_connection(("127.0.0.1", int(sys.argv[4]) + 1), 0.05) as connection,
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


def attack(name: str, file: Path, seconds: float) -> int:
    """Run one attack; print how often."""
    account = accounts.load(file)
    with zbus.connect(account.connect, account=account) as bus:
        end_s = time.monotonic() + seconds
        count = bus.use(lambda session: {**ATTACKS, **OTHERS}[name](session, end_s))
    print(count, flush=True)
    os._exit(0)  # sessions that the router has closed need no farewell


# -- the class -----------------------------------------------------------------------------------


class Program:
    """A `beatrix` program whose lines are kept."""

    def __init__(self, *words: str, account: Path | None = None) -> None:
        self.lines: list[str] = []
        self._child = subprocess.Popen(
            [sys.executable, "-m", "beatrix_zenoh.cli", *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env={**os.environ, "BEATRIX_ACCOUNT": str(account or "")},
        )
        self.pid = self._child.pid
        threading.Thread(target=self._read, daemon=True).start()
        until(lambda: self.count("^ready") > 0)

    def _read(self) -> None:
        for line in self._child.stdout or ():
            self.lines.append(line)

    def count(self, pattern: str) -> int:
        """Return the number of lines that contain a pattern."""
        return sum(bool(re.search(pattern, line)) for line in self.lines)

    def end(self) -> None:
        """End the program."""
        self._child.terminate()
        self._child.wait(10)


def until(holds: Callable[[], bool]) -> None:
    """Wait until a condition holds."""
    deadline_s = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline_s
        time.sleep(0.02)


def memory_mib(pid: int) -> str:
    """Return the memory of the children of a process (MiB)."""
    found = []
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        with contextlib.suppress(OSError, IndexError):
            status = Path(f"/proc/{child}/status").read_text()
            found.append(str(int(status.partition("VmRSS:")[2].split()[0]) // 1024))
    return " + ".join(found)


class Users:
    """The teacher, who presses STOP of bea2, and the seat ana, who moves bea1; each in a thread."""

    def __init__(self, teacher: Robot, ana: Robot) -> None:
        self.stops: list[float | None] = []
        """times (s) until the answers; None: none"""
        self.motions: list[bool] = []
        self._ended = threading.Event()
        for work in (lambda: self._press(teacher), lambda: self._move(ana)):
            threading.Thread(target=work, daemon=True).start()

    def _press(self, robot: Robot) -> None:
        while not self._ended.is_set():
            begin_s = time.monotonic()
            try:
                robot.stop()
                self.stops.append(time.monotonic() - begin_s)
            except BeatrixError:
                self.stops.append(None)
            self._ended.wait(max(0.0, STOP_S - (time.monotonic() - begin_s)))

    def _move(self, robot: Robot) -> None:
        for goal in itertools.cycle((12, -12)):
            if self._ended.is_set():
                return
            try:
                robot.look(yaw=goal, speed=40)
                self.motions.append(abs(robot.positions().head.yaw - goal) < 0.5)
            except BeatrixError:
                self.motions.append(False)
                self._ended.wait(0.5)

    def end(self) -> None:
        """End both threads."""
        self._ended.set()


def rows(folder: Path, seconds: float) -> Iterator[list[str]]:
    """Yield a row for each attack, while `beatrix top` runs for the teacher."""
    file = folder / "class.toml"
    port = free_port()
    file.write_text(CLASS.format(port=port))
    provision.init(class_file.read(file), folder / "attacked")
    seats = folder / "attacked/seats"
    with contextlib.ExitStack() as stack:
        router = Program("router", "--class", str(file))
        stack.callback(router.end)
        nodes = [
            Program("hw", "--port", "virtual:", account=folder / f"attacked/robots/{robot}.toml")
            for robot in ROBOTS
        ]
        for node in nodes:
            stack.callback(node.end)

        def robot(name: str, seat: str) -> Robot:
            account = accounts.load(seats / f"{seat}.toml")
            client = stack.enter_context(Client(Settings(name, account.connect, seat, account=account)))
            return Robot(name, "hw", client=client, timeout_s=PATIENCE_S)

        top = [sys.executable, "-m", "beatrix_zenoh.cli", "top", "--json"]
        own = {**os.environ, "BEATRIX_ACCOUNT": str(seats / "teacher.toml")}
        stack.callback(subprocess.Popen(top, stdout=subprocess.DEVNULL, env=own).kill)
        teacher, ana = robot("bea2", "teacher"), robot("bea1", "ana")
        ana.make_ready()
        for name in sys.argv[2:] or ATTACKS:
            ends, lost = router.count("has ended"), sum(node.count("was lost") for node in nodes)
            users = Users(teacher, ana)
            card = "dan" if name == "tokens" else "cem"  # it is put out for a minute
            words = ["attack", name, str(seats / f"{card}.toml"), str(port), str(seconds)]
            attacker = subprocess.run(
                [sys.executable, __file__, *words], capture_output=True, text=True, check=False
            )
            users.end()
            time.sleep(1.0)
            took = sorted(1e3 * wait for wait in users.stops if wait is not None)
            yield [
                name,
                attacker.stdout.strip() or "ended",
                f"{statistics.median(took):.0f} / {took[int(0.99 * len(took))]:.0f} / {took[-1]:.0f}",
                f"{users.stops.count(None)} of {len(users.stops)}",
                f"{sum(users.motions)} of {len(users.motions)}",
                str(sum(node.count("was lost") for node in nodes) - lost),
                str(router.count("has ended") - ends),
                memory_mib(router.pid),
                f"{os.getloadavg()[0]:.0f}",
            ]


HEADS: Final = (
    "attack, of one pupil",
    "times",
    "STOP p50 / p99 / max ms",
    "unanswered",
    "motions",
    "robots lost",
    "router ends",
    "MiB",
    "load",
)


def main() -> None:
    """Print the table, or run one attack."""
    if sys.argv[1:2] == ["attack"]:
        attack(sys.argv[2], Path(sys.argv[3]), float(sys.argv[5]))
    with TemporaryDirectory() as folder:
        print("| " + " | ".join(HEADS) + " |", flush=True)
        print("|---" * len(HEADS) + "|", flush=True)
        for row in rows(Path(folder), float(sys.argv[1]) if len(sys.argv) > 1 else 80.0):
            print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
