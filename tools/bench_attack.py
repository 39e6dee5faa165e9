"""Attacks on a class with a pupil's card: `python tools/bench_attack.py [SECONDS]` prints a table, a row for each attack.

A router of a class, two virtual robots, the teacher who presses STOP five times a second, a pupil who moves a robot, and
one attack after the other for SECONDS each (default 80: half an hour), all in real processes on loopback.
`python tools/bench_attack.py SECONDS NAME ...` makes only these attacks.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import statistics
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import attacks

from beatrix_zenoh import BeatrixError, Robot, class_file
from beatrix_zenoh import account as accounts
from beatrix_zenoh.classroom import provision
from beatrix_zenoh.client import Client
from beatrix_zenoh.processes import free_port
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


def shares(took: list[float]) -> tuple[float, float, float]:
    """Return median, the 99th hundredth and the largest of sorted times."""
    return statistics.median(took), took[int(0.99 * len(took))], took[-1]


def ends(lines: list[str]) -> str:
    """Return how often each router has ended, and why, from the lines of their parent."""
    found = re.findall(r"The router of (?:the )?(\w+).* has ended \((.*?)\)", "".join(lines))
    return ", ".join(f"{who} {count} x: {why}" for (who, why), count in Counter(found).items()) or "0"


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
        for name in sys.argv[2:] or attacks.ATTACKS:
            before, lost = len(router.lines), sum(node.count("was lost") for node in nodes)
            users = Users(teacher, ana)
            card = "dan" if name == "tokens" else "cem"  # it is put out for a minute
            words = [name, str(seats / f"{card}.toml"), str(port), str(seconds)]
            attacker = subprocess.run(
                [sys.executable, attacks.__file__, *words], capture_output=True, text=True, check=False
            )
            users.end()
            time.sleep(1.0)
            took = sorted(1e3 * wait for wait in users.stops if wait is not None)
            yield [
                name,
                attacker.stdout.strip() or "ended",
                " / ".join(f"{wait:.0f}" for wait in shares(took)) if took else "none",
                f"{users.stops.count(None)} of {len(users.stops)}",
                f"{sum(users.motions)} of {len(users.motions)}",
                str(sum(node.count("was lost") for node in nodes) - lost),
                ends(router.lines[before:]),
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
    """Print the table."""
    with TemporaryDirectory() as folder:
        print("| " + " | ".join(HEADS) + " |", flush=True)
        print("|---" * len(HEADS) + "|", flush=True)
        for row in rows(Path(folder), float(sys.argv[1]) if len(sys.argv) > 1 else 80.0):
            print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
