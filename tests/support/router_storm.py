"""A storm at a router: sessions that join and leave, while other programs ask who is there and stop robots.

`python tests/support/router_storm.py 60` prints the figures of 60 s; the exit code is 1 if the router has failed to answer.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from robots import Process, free_endpoint, start_router

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.cli import graph
from beatrix_zenoh.cli.listing import online
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.monitor import Monitor, Seats
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.terminal.states import look_up

SEATS = 12
ANSWER_S = 2.0
"""Longest time (s) for the router to answer on a busy machine."""
PROBE_S = 0.1
NAME, STAYS = "bea", "stays"
"""The robot, and a seat that watches it throughout."""


@dataclass
class Storm:
    """The storm at one endpoint, and what it has counted."""

    endpoint: str
    seconds: float
    done: Counter[str] = field(default_factory=Counter)
    """Number of joined sessions, of each verb, and of answers of the router."""
    end_s: float = 0.0
    slowest_s: float = 0.0
    """Longest time (s) in which the router has answered."""
    seen: int = 0
    """Largest number of programs in one picture of `graph`."""
    trouble: list[str] = field(default_factory=list)
    """The first errors of each kind of work; the storm ends with the first one."""

    def run(self) -> Storm:
        """Run the storm, beside a seat that stays; return when it has ended."""
        with self._client(STAYS) as client, Robot(NAME, "hw", client=client).stream():
            self._run()
            if not self.trouble:
                self._repeat("graph", lambda who: self._graph(who, all_left=True))
        return self

    def _run(self) -> None:
        self.end_s = time.monotonic() + self.seconds
        works: list[tuple[str, Callable[[str], None]]] = [
            *((f"seat{number}", self._seat) for number in range(SEATS)),
            ("graph", self._graph),
            ("ls", self._ls),
            ("top", self._top),
            ("stop", self._stop),
            ("router", self._probe),
        ]
        threads = [
            threading.Thread(target=self._repeat, args=work, name=work[0], daemon=True) for work in works
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(max(1.0, self.end_s + 20.0 - time.monotonic()))
        self.trouble += [f"{thread.name} has not ended" for thread in threads if thread.is_alive()]
        self.end_s = time.monotonic() + 1.0

    def _repeat(self, name: str, work: Callable[[str], None]) -> None:
        while time.monotonic() < self.end_s and not self.trouble:
            try:
                work(name)
            except (BeatrixError, AssertionError, KeyError) as error:
                left_s = self.end_s - time.monotonic()
                self.trouble.append(f"{name}, {self.seconds - left_s:.1f} s after the start: {error}")
            self.done[name.rstrip("0123456789")] += 1

    def _client(self, who: str) -> Client:
        return Client(Settings(NAME, self.endpoint, who))

    def _seat(self, who: str) -> None:
        """Join, watch the robot, ask it, and leave."""
        with self._client(who) as client:
            robot = Robot(NAME, "hw", client=client, timeout_s=10.0)
            with robot.stream(), robot.events(), robot.status_stream():
                robot.status()

    def _graph(self, who: str, *, all_left: bool = False) -> None:
        with self._client(who) as client:
            programs = {program.title: program for program in graph.read(client)}
        node = programs[f"{NAME} (hw)"]
        stays = [program for title, program in programs.items() if title.startswith(f"seat {STAYS}")]
        assert [program.watches(node) for program in stays] == [["state/positions"]], programs
        assert not (all_left and len(programs) > 2), sorted(programs)
        self.seen = max(self.seen, len(programs))

    def _ls(self, who: str) -> None:
        with self._client(who) as client:
            found = [robot.place for robot in look_up(client)]
        assert found == [(NAME, "hw")], found

    def _top(self, who: str) -> None:
        with self._client(who) as client, Monitor(client) as monitor:
            Seats(client)
            monitor.settle()
            online(monitor)

    def _stop(self, who: str) -> None:
        with self._client(who) as client:
            assert Robot(NAME, "hw", client=client, timeout_s=10.0).stop().result

    def _probe(self, _: str) -> None:
        with zbus.connect(self.endpoint) as bus:
            while time.monotonic() < self.end_s and not self.trouble:
                begin_s = time.monotonic()
                assert bus.router_answers(ANSWER_S), f"the router has not answered within {ANSWER_S} s"
                self.slowest_s = max(self.slowest_s, time.monotonic() - begin_s)
                self.done["answers"] += 1
                threading.Event().wait(PROBE_S)


def storm(seconds: float) -> Storm:
    """Start a router and a virtual robot, and return their storm of this duration (s)."""
    endpoint = free_endpoint()
    router = start_router(endpoint)
    try:
        where = ("--name", NAME, "--connect", endpoint)
        node = Process("-m", "hw_node", *where, "--port", "virtual:", traced=False)
        try:
            node.expect("ready")
            made = Storm(endpoint, seconds).run()
        finally:
            node.end()
    finally:
        try:
            router.end()
        except subprocess.TimeoutExpired as error:
            raise AssertionError(f"the router did not end; {made.trouble}") from error
    return made


if __name__ == "__main__":
    found = storm(float(sys.argv[1]))
    print(f"{dict(found.done)}, at most {found.seen} programs, slowest answer {found.slowest_s:.3f} s")
    print("\n".join(found.trouble) or "The router has answered throughout.", flush=True)
    sys.exit(bool(found.trouble))
