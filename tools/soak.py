"""Run both robots, a page, recorders and programs for hours, and find what grows or is lost.

    python tools/soak.py [--hours 2] [--page docs/reference/soak.md]

A router, a simulation, a virtual robot, `beatrix web` with pages that stay and pages that come and go, a recorder
without and one with pictures, and a program that previews, commits, aborts and stops at random. The router is ended and
started again every 20 minutes, in a short soak three times, and once before memory is first measured: what a process
loads when it connects again is no leak. The exit code is 1 if a process grows, has ended, or if a reader has lost
samples while the router ran.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, TextIO

import numpy as np
import soak_figures
from bench_node import ROOT, Served, free_endpoint
from bench_pages import Page

from beatrix_zenoh import BeatrixError, Robot, Twin, memory
from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.twin import Plan
from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.recording.losses import POSITIONS, Losses
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.samples import lost
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import signals_interrupt

NAME: Final = "soak"
SIDES: Final = ("sim", "hw")
RESTART_S: Final = 1200.0
BACK_S: Final = 15.0
"""Time (s) after a restart of the router whose lost samples are counted apart: everybody connects again."""
LOOK_S: Final = 5.0
MOTION_S: Final = 20.0
"""Longest time (s) of a motion; one that takes longer hangs."""
VISIT_S: Final = 20.0
AFTER_STOP_S: Final = 3.5


@dataclass
class Soak:
    """What all threads share."""

    endpoint: str
    web_port: int
    over: threading.Event = field(default_factory=threading.Event)
    counts: Counter[str] = field(default_factory=Counter)
    """what was done, and what came of it; each key is written by one thread"""
    restarts: list[float] = field(default_factory=list)
    """wall-clock times (s) at which the router was ended"""
    faults: list[str] = field(default_factory=list)
    lost: Counter[tuple[str, str]] = field(default_factory=Counter)
    """positions by side, and `read`, `lost` or `restart`"""

    def settings(self, who: str) -> Settings:
        """Return the settings of a program of this seat."""
        return Settings(NAME, self.endpoint, who)

    def disturbed(self, wall_s: float) -> bool:
        """Return whether the router was restarted within the last BACK_S."""
        return any(began <= wall_s <= began + BACK_S for began in self.restarts)


def make_ready(soak: Soak, twin: Twin) -> None:
    """Bring both robots out of whatever state they are in."""
    for robot in (twin.sim, twin.hw):
        if robot.status().fault is Fault.EMERGENCY:
            soak.counts["resets"] += 1
            robot.reset()
    twin.make_ready()


def drive(soak: Soak) -> None:
    """Preview, commit, abort, replace and stop at random until the soak is over."""
    dice = random.Random(1)
    with Client(soak.settings("driver")) as client, Client(soak.settings("other")) as second:
        twin, other = Twin(NAME, client=client), Robot(NAME, "sim", client=second)
        while not soak.over.wait(dice.uniform(0.0, 1.0)):
            try:
                make_ready(soak, twin)
                soak.counts["previews"] += 1
                yaw, pitch, roll = dice.uniform(-30, 30), dice.uniform(-12, 12), dice.uniform(-12, 12)
                plan = twin.preview(yaw=yaw, pitch=pitch, roll=roll)
                carry_out(soak, dice, plan, other)
            except TimeoutError:
                soak.faults.append(f"A motion took longer than {MOTION_S:.0f} s.")
            except BeatrixError as error:
                soak.counts[f"refused or lost: {error.reason.name}"] += 1
                # A motion within 3 s after the STOP of another seat is refused, and the 3 s begin again.
                soak.over.wait(AFTER_STOP_S if error.reason is Reason.STOPPED else 0.5)


def carry_out(soak: Soak, dice: random.Random, plan: Plan, other: Robot) -> None:
    """Do one of many things with a plan."""
    what = dice.choices(
        ("waited", "aborted before", "aborted after", "replaced", "stopped", "emergency"),
        (50, 10, 10, 10, 15, 5),
    )[0]
    soak.counts[f"plans: {what}"] += 1
    if what == "aborted before":
        plan.abort()
        return
    motion = plan.commit(lead_s=dice.choice((0.0, 0.5, 1.5)), wait=False)
    if what == "replaced":
        soak.over.wait(dice.uniform(0.0, 0.5))
        return
    if what != "waited":
        soak.over.wait(dice.uniform(0.0, 1.5))
        began_s = time.monotonic()
        if what == "aborted after":
            plan.abort()
        elif what == "stopped":
            other.stop()
        else:
            other.emergency_stop()
        soak.counts["slowest STOP or abort [ms]"] = max(
            soak.counts["slowest STOP or abort [ms]"], round(1e3 * (time.monotonic() - began_s))
        )
    error = motion.exception(MOTION_S)
    reason = error.reason.name if isinstance(error, BeatrixError) else error and repr(error)
    soak.counts[f"motions: {reason or 'arrived'}"] += 1


def watch(soak: Soak) -> None:
    """Receive all positions, and count those that are lost; those lost around a restart apart."""
    losses, disturbed = Losses(), False

    def count() -> None:
        for (place, _), one in losses.counts({}).items():
            soak.lost[place[1], "read"] += one.received
            soak.lost[place[1], "restart" if disturbed else "lost"] += one.lost

    with Client(soak.settings("watcher")) as client:
        with subscription.positions(client, NAME, "*", timeout_s=None) as stream:
            while not soak.over.is_set():
                for arrival in stream.take_arrivals(0.5):
                    if soak.disturbed(time.time()) != disturbed:
                        count()
                        losses, disturbed = Losses(), not disturbed
                    losses.received(((NAME, arrival.side), POSITIONS), arrival.value.seq)
            soak.counts["positions dropped by the watcher"] = stream.dropped
        count()


def visit(soak: Soak) -> None:
    """Open a session, look at the robots and close it, again and again."""
    while not soak.over.wait(VISIT_S):
        with contextlib.suppress(BeatrixError), Client(soak.settings("visitor")) as client:
            with subscription.status(client, NAME, "*") as stream:
                stream.next(3.0)
            for side in SIDES:
                Robot(NAME, side, client=client).info()
            soak.counts["visits of programs"] += 1


async def pages(soak: Soak) -> None:
    """Keep two pages open, and open and close a third one; it presses STOP now and then."""
    dice = random.Random(2)
    lasting = [Page(soak.web_port, NAME) for _ in range(2)]
    for page in lasting:
        await page.open()
    while not soak.over.is_set():
        visitor = Page(soak.web_port, NAME)
        await visitor.open()
        soak.counts["visits of pages"] += 1
        for _ in range(20):
            await asyncio.sleep(0.5)
            if soak.over.is_set():
                break
        if dice.random() < 0.2:
            soak.counts["STOPs of pages"] += 1
            visitor.send("stop", robot=NAME, stop=f"b{soak.counts['STOPs of pages']}")
            await asyncio.sleep(0.5)
        visitor.close()
    soak.counts["views of the lasting pages"] = sum(page.views for page in lasting)
    for page in lasting:
        page.close()


def guarded(soak: Soak, work: Callable[[Soak], None]) -> threading.Thread:
    """Start a thread whose end by an exception is a fault."""

    def run() -> None:
        try:
            work(soak)
        except Exception as error:  # noqa: BLE001 - the soak goes on, and its page says what failed
            soak.faults.append(f"`{work.__name__}` has failed: {error!r}")

    thread = threading.Thread(target=run, name=work.__name__)
    thread.start()
    return thread


def browse(soak: Soak) -> None:
    """Run `pages` in this thread."""
    asyncio.run(pages(soak))


class Logged(Served):
    """A process that prints `ready`, and whose stderr goes to a file."""

    def __init__(self, module: str, *words: str, errors: TextIO) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", module, *words],
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            cwd=ROOT,
            env={**os.environ, "BEATRIX_ACCOUNT": ""},
        )
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line.startswith("ready"), f"{module} did not start: {line}"


class Processes:
    """The processes of the soak, with their output in a folder."""

    def __init__(self, soak: Soak, folder: Path) -> None:
        self._folder, self._soak = folder, soak
        self.served: dict[str, Served] = {}

    def start(self) -> None:
        """Start all, and wait until they are ready."""
        to = ("--connect", self._soak.endpoint)
        self._begin("router", "beatrix_zenoh.cli", "router", "--listen", self._soak.endpoint)
        self._begin("simulation", "sim_node", "--name", NAME, "--ready", *to)
        self._begin("hardware", "hw_node", "--name", NAME, "--port", "virtual:", *to)
        self._begin(
            "page", "beatrix_zenoh.cli", "web", *to, "--port", str(self._soak.web_port), "--who", "web"
        )
        for name, path in self.recordings().items():
            hz = "5" if name == "recorder with pictures" else "0"
            self._begin(name, "beatrix_zenoh.cli", "record", str(path), *to, "--cameras", hz)

    def recordings(self) -> dict[str, Path]:
        """Return the files of the recorders."""
        return {
            "recorder": self._folder / "plain.rrd",
            "recorder with pictures": self._folder / "pictures.rrd",
        }

    def _begin(self, name: str, module: str, *words: str) -> None:
        with (self._folder / f"{name}.log").open("a", encoding="utf-8") as errors:  # the process has it, too
            self.served[name] = Logged(module, *words, errors=errors)

    def restart_router(self) -> None:
        """End the router, and start it again at the same address."""
        self._soak.restarts.append(time.time())
        self.served["router"].end()
        self._begin("router", "beatrix_zenoh.cli", "router", "--listen", self._soak.endpoint)

    def pids(self) -> dict[str, int]:
        """Return the processes by name, with this one."""
        return {name: one.pid for name, one in self.served.items()} | {"programs": os.getpid()}

    def end(self) -> None:
        """End all, the router last; note those that do not end, and tracebacks."""
        for name, one in reversed(self.served.items()):
            try:
                one.end()
            except Exception as error:  # noqa: BLE001 - the others must end, too
                self._soak.faults.append(f"{name} did not end: {error}")
                os.kill(one.pid, signal.SIGKILL)
        for log in sorted(self._folder.glob("*.log")):
            text = log.read_text(encoding="utf-8", errors="replace")
            if "Traceback" in text or "panicked" in text:
                self._soak.faults.append(f"{log.stem} has printed: {text.strip()[-400:]}")


def measure(soak: Soak, processes: Processes, book: soak_figures.Book) -> None:
    """Look at all processes until the time is over, and restart the router in between."""
    began_s, total_s = time.monotonic(), book.total_s
    period_s = min(RESTART_S, total_s / 4)
    due_s = soak_figures.windows(total_s)[0][0] / 2
    while (at_s := time.monotonic() - began_s) < total_s:
        book.write(processes.pids(), at_s)
        if at_s >= due_s and total_s - at_s > 2 * BACK_S:
            processes.restart_router()
            due_s += period_s
        gone = [name for name, seen_s in book.last_s.items() if name in processes.served and seen_s != at_s]
        if gone:
            soak.faults.append(f"{', '.join(gone)} ended after {at_s:.0f} s.")
            return
        print(f"\r{at_s:6.0f} of {total_s:.0f} s", end="", file=sys.stderr, flush=True)
        time.sleep(LOOK_S)


def readers_of(soak: Soak, recordings: dict[str, Path]) -> Iterator[tuple[str, ...]]:
    """Yield reader, positions read, lost while the router ran, and lost within BACK_S of its restarts."""
    for side in SIDES:
        yield f"program, {side}", *(str(soak.lost[side, what]) for what in ("read", "lost", "restart"))
    for name, path in recordings.items():
        for (_, side), samples in read(path).robots.items():
            times_s = samples.time_ns / 1e9
            edges = sorted(edge for began in soak.restarts for edge in (began, began + BACK_S))
            parts = np.searchsorted(edges, times_s)
            within = [
                lost(samples.seq[parts == part], samples.repeats[parts == part]) or 0
                for part in range(0, len(edges) + 1, 2)
            ]
            total = samples.lost or 0
            yield f"{name}, {side}", str(len(times_s)), str(sum(within)), str(total - sum(within))


def run(hours: float, folder: Path) -> tuple[str, list[str]]:
    """Run the soak; return the page and what is wrong."""
    soak = Soak(free_endpoint(), int(free_endpoint().rpartition(":")[2]))
    processes, book = Processes(soak, folder), soak_figures.Book(hours * 3600)
    threads: list[threading.Thread] = []
    try:
        processes.start()
        memory.keep_loaded()  # the pages of this process leave as much as those of a server
        threads = [guarded(soak, work) for work in (drive, watch, visit, browse)]
        measure(soak, processes, book)
    finally:
        soak.over.set()
        for thread in threads:
            thread.join(2 * MOTION_S)
            if thread.is_alive():
                soak.faults.append(f"`{thread.name}` hangs.")
        processes.end()
    rows = list(book.rows())
    readers = list(readers_of(soak, processes.recordings()))
    soak.counts["restarts of the router"] = len(soak.restarts)
    faults = soak.faults + [fault for row in rows for fault in row.faults()]
    faults += [
        f"{reader} has lost {missing} positions" for reader, _, missing, _ in readers if missing != "0"
    ]
    done: list[tuple[str, ...]] = [(name, str(number)) for name, number in sorted(soak.counts.items())]
    others = (
        (
            ("reader of positions", "read", "lost", f"lost within {BACK_S:.0f} s of a restart of the router"),
            readers,
        ),
        (("what was done", "number"), done),
    )
    return soak_figures.page(rows, others, faults, hours), faults


def main() -> None:
    """Run the soak, print the page, and write it if wanted."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--hours", type=float, default=2.0)
    parser.add_argument(
        "--page", type=Path, help=f"write the page to this file, in {ROOT.name}/docs/reference"
    )
    words = parser.parse_args()
    with signals_interrupt(), TemporaryDirectory(prefix="beatrix-soak-") as folder:
        text, faults = run(words.hours, Path(folder))
    print(f"\n{text}")
    if words.page is not None:
        words.page.write_text(text, encoding="utf-8")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
