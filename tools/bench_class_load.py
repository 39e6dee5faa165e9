"""Measure the load of a class of robots and seats in processes, and that of bare Zenoh with the same messages.

The figures are the numbers of delivered messages, their ages, and processor time.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Final, Self

from bench_node import ROOT, Row, Served, cpu_s, free_endpoint

from beatrix_zenoh.contract._generated import keys

LASTS_S: Final = 5.0
PER_PROCESS: Final = 10
"""Robots or seats in one process: 60 processes need more than two cores even with bare Zenoh, and measure the computer."""
EVERYONE: Final = keys.positions("*", "hw")
PROGRAM: Final = str(ROOT / "tools/class_load.py")
ROUTER: Final = """
import json, sys, zenoh
config = zenoh.Config()
for key, value in {"mode": "router", "listen/endpoints": [sys.argv[1]], "scouting/multicast/enabled": False}.items():
    config.insert_json5(key, json.dumps(value))
with zenoh.open(config):
    print("ready", flush=True)
    sys.stdin.read()
"""


class Program:
    """A process that prints `ready`, and then reads lines until the end of its input."""

    def __init__(self, *command: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, *command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT
        )

    def line(self) -> str:
        """Return the next line of its output; empty at the end of the output."""
        assert self._process.stdout is not None
        return self._process.stdout.readline()

    def say(self, text: str) -> None:
        """Write a line to its standard input."""
        assert self._process.stdin is not None
        print(text, file=self._process.stdin, flush=True)

    def cpu_s(self) -> float:
        """Return the processor time used so far (s)."""
        return cpu_s(self._process.pid)

    def close(self) -> None:
        """Close the standard input of the process, and wait for the end of the process."""
        self._process.communicate(timeout=20)


def started(role: str, members: list[tuple[str, str]]) -> list[Program]:
    """Start and return processes of PER_PROCESS robots or seats; `members`: key of the robot and place of each."""
    groups = [members[at : at + PER_PROCESS] for at in range(0, len(members), PER_PROCESS)]
    programs = [Program(PROGRAM, role, *chain.from_iterable(group)) for group in groups]
    for program in programs:
        assert program.line() == "ready\n"
    return programs


@contextlib.contextmanager
def bare_router() -> Iterator[tuple[Program, str]]:
    """Run a router with Zenoh's own settings; yield its process and its endpoint."""
    endpoint = free_endpoint()
    router = Program("-c", ROUTER, endpoint)
    assert router.line() == "ready\n"
    try:
        yield router, endpoint
    finally:
        router.close()


@dataclass(frozen=True)
class Load:
    """The messages that the seats have received, and the processor time used."""

    sent: int
    """number of messages that should have arrived"""
    ages_ms: list[float]
    """ages of the messages that arrived, sorted"""
    cpu: tuple[float, float, float]
    """share of a core that a robot uses on average, that a seat uses on average, and that the router uses"""

    def age_ms(self, share: float) -> float:
        """Return the age (ms) that this share of the messages does not exceed."""
        return self.ages_ms[min(len(self.ages_ms) - 1, int(share * len(self.ages_ms)))]

    def __str__(self) -> str:
        ages = " / ".join(f"{self.age_ms(share):.1f}" for share in (0.5, 0.99, 1.0))
        cpu = " / ".join(f"{100 * share:.1f}" for share in self.cpu)
        return f"{len(self.ages_ms)}/{self.sent}; {ages}; {cpu}"


class Crowd:
    """Robots and as many seats at one router, PER_PROCESS in a process, each with a session of its own.

    `places` has a pair for each robot and its seat: the files of their accounts, or twice the endpoint of a router.
    """

    def __init__(self, router: Served | Program, places: list[tuple[str, str]]) -> None:
        self._router = router
        self._count = len(places)
        watched = [keys.positions(f"rob{number:02d}", "hw") for number in range(1, len(places) + 1)]
        robots, seats = zip(*places, strict=True)
        self._robots = started("robot", list(zip(watched, robots, strict=True)))
        self._seats = started("seat", list(zip(watched, seats, strict=True)))

    def begin(self, *, all_robots: bool, lasts_s: float = LASTS_S) -> None:
        """Make each seat subscribe to its own robot, or to all robots, for `lasts_s` (s)."""
        for seats in self._seats:
            seats.say(f"{lasts_s} {EVERYONE if all_robots else ''}")

    def watch(self, *, all_robots: bool) -> Load:
        """Return the load while each seat subscribes to its own robot, or to all robots."""
        began, before = time.monotonic(), self._cpu_s()
        self.begin(all_robots=all_robots)
        found = [seat for seats in self._seats for seat in json.loads(seats.line())]
        seconds, after = time.monotonic() - began, self._cpu_s()
        expected = self._count if all_robots else 1
        unheard = sum(expected - seat["robots"] for seat in found)
        cpu = [(late - early) / seconds for early, late in zip(before, after, strict=True)]
        return Load(
            sum(seat["sent"] for seat in found) + round(unheard * LASTS_S * keys.positions.rate_hz),
            sorted(age for seat in found for age in seat["ages_ms"]),
            (cpu[0], cpu[1], cpu[2]),
        )

    def skip(self) -> None:
        """Wait for the results of `begin`, and discard them."""
        for seat in self._seats:
            seat.line()

    def _cpu_s(self) -> tuple[float, float, float]:
        robots = sum(robot.cpu_s() for robot in self._robots) / self._count
        seats = sum(seat.cpu_s() for seat in self._seats) / self._count
        return robots, seats, self._router.cpu_s()

    def close(self) -> None:
        """End all processes."""
        for program in (*self._seats, *self._robots):
            program.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def crowd(router: Served, folder: Path, count: int) -> Crowd:
    """Return `count` robots and seats of the class whose accounts are in the folder."""
    numbers = [f"{number:02d}" for number in range(1, count + 1)]
    return Crowd(
        router,
        [(str(folder / f"robots/rob{one}.toml"), str(folder / f"seats/seat{one}.toml")) for one in numbers],
    )


def rows(router: Served, folder: Path, counts: tuple[int, ...]) -> Iterator[Row]:
    """Measure positions at 50 Hz at the router of the class, and then at a bare router; yield the rows."""
    for count in counts:
        loads: dict[bool, list[Load]] = {mode: [] for mode in (False, True)[: min(count, 2)]}
        with crowd(router, folder, count) as ours:
            for mode, found in loads.items():
                found.append(ours.watch(all_robots=mode))
        with bare_router() as (bare, endpoint), Crowd(bare, [(endpoint, endpoint)] * count) as others:
            for mode, found in loads.items():
                found.append(others.watch(all_robots=mode))
        for mode, (own, reference) in loads.items():
            figure = f"{count} robots, each seat watches {'all' if mode else 'its own'}"
            ratios = [own.age_ms(share) / reference.age_ms(share) for share in (0.5, 0.99)]
            ratios.append(own.cpu[2] / max(reference.cpu[2], 0.001))
            yield f"{figure}", str(own), "nothing lost, p99 <= 2 x bare" if count == 30 else ""
            yield "  the same with bare Zenoh", str(reference), ""
            yield "  ratios: p50, p99, CPU of the router", " / ".join(f"{one:.2f}" for one in ratios), ""
