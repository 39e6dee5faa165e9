"""Benchmark of a class and its router, in real processes on loopback: load, STOP, leases, a restarted router.

`python tools/bench_classroom.py [ROBOTS...]` prints the figures; ROBOTS are numbers of robots, by default 1, 10 and 30.
"""

from __future__ import annotations

import contextlib
import os
import signal
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import bench_class_load
import msgspec
from bench_node import ROOT, Bare, Row, Served, paced, spread_ms
from cable import Cable

from beatrix_zenoh import BeatrixError, Robot, class_file
from beatrix_zenoh import account as accounts
from beatrix_zenoh.classroom import provision
from beatrix_zenoh.client import Client, lease
from beatrix_zenoh.contract._generated.messages import EventKind, LeaseAction, Status
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.settings import Settings

HOSTILE: Final = str(ROOT / "tools/hostile.py")
NAME: Final = "bea1"
RESTING: Final = "bea2"
"""Robots with real nodes; the others only publish."""
CLASS: Final = """
name = "bench"
addresses = ["127.0.0.1"]
seats = 30
robots = [{robots}]
[router]
port = {port}
"""
STOPS: Final = 300
CROWD_S: Final = 15.0
"""Time (s) during which all seats subscribe to all robots, longer than the STOPs take."""
REPEATS: Final = 5
PATIENCE_S: Final = 20.0
REFUSED_S: Final = 180.0
"""Longest time (s) for which a router may accept no session after hostile traffic."""
BACK_SEATS: Final = 5


class School:
    """A class with its accounts in a folder, and its router."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / "class.toml"
        robots = [NAME, RESTING, *(f"rob{number:02d}" for number in range(1, 31))]
        self.file.write_text(CLASS.format(port=free_port(), robots=", ".join(f'"{one}"' for one in robots)))
        self.classroom = class_file.read(self.file)
        self.folder = folder / "bench"
        provision.init(self.classroom, self.folder)
        self.router = self.start_router()

    def start_router(self) -> Served:
        """Start the router, or start it again."""
        self.router = Served("beatrix_zenoh.cli", "router", "--class", str(self.file))
        return self.router

    def path(self, name: str) -> Path:
        """Return the file of the account of a seat or a robot."""
        return next(self.folder.glob(f"*s/{name}.toml"))

    @contextlib.contextmanager
    def robot(self, seat: str) -> Iterator[Robot]:
        """Yield the robot NAME, with a session of this seat's account."""
        account = accounts.load(self.path(seat))
        with Client(Settings(NAME, account.connect, seat, account=account)) as client:
            yield Robot(NAME, "hw", client=client, timeout_s=PATIENCE_S)


# -- STOP ----------------------------------------------------------------------------------------


def stops(what: str, robot: Robot, bare: Bare) -> Iterator[Row]:
    """Yield the times from STOP of the teacher to the reply of a robot at rest, and of bare queries sent in between."""
    reference: list[float] = []

    def ask() -> None:
        began = time.perf_counter()
        try:
            robot.stop()
        except BeatrixError:  # the reply is late on a busy computer, although STOP may have stopped the robot
            unanswered.append(time.perf_counter() - began)
        else:
            took.append(time.perf_counter() - began)
        time.sleep(0.005)
        began = time.perf_counter()
        bare.query()
        reference.append(time.perf_counter() - began)

    took: list[float] = []
    unanswered: list[float] = []
    paced(ask, STOPS)
    ratios = [statistics.median(took) / statistics.median(reference), p99(took) / p99(reference)]
    yield f"STOP, {what} [ms], failed", f"{spread_ms(took)}, {len(unanswered)}", "p99 < 50, 0"
    yield "  a bare query at another router [ms]", spread_ms(reference), ""
    yield "  ratios: p50, p99", " / ".join(f"{ratio:.1f}" for ratio in ratios), ""


def p99(seconds: list[float]) -> float:
    """Return the time (s) that 99 % of the times do not exceed."""
    return sorted(seconds)[int(0.99 * len(seconds))]


@contextlib.contextmanager
def program(*command: str, account: Path | None = None) -> Iterator[subprocess.Popen[str]]:
    """Run a program that prints `ready`, and kill it at the end."""
    child = subprocess.Popen(
        [sys.executable, *command],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env={**os.environ, "BEATRIX_ACCOUNT": str(account or "")},
    )
    assert child.stdout is not None
    line = child.stdout.readline()
    assert line == "ready\n", line
    try:
        yield child
    finally:
        child.kill()
        child.communicate()


def recording(school: School) -> bytes:
    """Return the bytes that a program sends with the account of a seat to read the status of a robot."""
    account = accounts.load(school.path("seat03"))
    with Cable("127.0.0.1", school.classroom.router.port + 1) as cable:
        account = msgspec.structs.replace(account, connect=f"tls/127.0.0.1:{cable.port}")
        with Client(Settings(NAME, account.connect, "seat03", account=account)) as client:
            Robot(NAME, "hw", client=client).status()
        return bytes(max(cable.recorded, key=len))


def stop_rows(school: School, count: int) -> Iterator[Row]:
    """Yield the times of STOP without load, beside a flooding seat, and while all seats subscribe."""
    with school.robot("teacher") as robot, bench_class_load.bare_router() as (_, endpoint):
        bare = Bare(endpoint)
        try:
            robot.make_ready()
            with robot.lease():  # so that the flooding seat moves nothing, and STOP is answered at once
                yield from stops("without load", robot, bare)
                with program(HOSTILE, "flood", NAME, account=school.path("seat01")):
                    yield from stops("beside a flooding seat", robot, bare)
                yield "hostile traffic ends -> the next session opens [s]", f"{opens_s(school):.2f}", ""
                with bench_class_load.crowd(school.router, school.folder, count) as crowd:
                    crowd.begin(all_robots=True, lasts_s=CROWD_S)
                    time.sleep(1.0)
                    yield from stops(f"while {count} seats watch {count} robots", robot, bare)
                    crowd.skip()
        finally:
            bare.close()


def opens_s(school: School) -> float:
    """Return the time (s) until a session opens: after refused connections the router accepts none for a while."""
    began = time.monotonic()
    while True:
        try:
            with school.robot("seat02"):
                return time.monotonic() - began
        except BeatrixError:
            if time.monotonic() - began > REFUSED_S:
                raise


def hostile_rows(school: School) -> Iterator[Row]:
    """Yield the times of STOP under attack. Afterwards the router opens no session for minutes (decision 0045)."""
    recorded = school.folder / "recorded"
    recorded.write_bytes(recording(school))
    attack = ("attack", "127.0.0.1", str(school.classroom.router.port), str(recorded))
    with school.robot("teacher") as robot, bench_class_load.bare_router() as (_, endpoint):
        bare = Bare(endpoint)
        try:
            robot.make_ready()
            with robot.lease(), program(HOSTILE, *attack):
                yield from stops("under hostile traffic", robot, bare)
        finally:
            bare.close()


# -- leases --------------------------------------------------------------------------------------


def handover(robot: Robot, seat: str, fault: Callable[[], object]) -> tuple[float, float]:
    """Return the times (s) from a fault of the holder until the robot rests, and until `seat` holds the robot."""
    rests = held = 0.0
    with robot.status_stream() as statuses:
        began = time.monotonic()
        fault()
        while not (rests and held):
            status: Status = statuses.next(PATIENCE_S)
            now = time.monotonic() - began
            rests = rests or (0.0 if status.moving else now)
            held = held or (now if status.holder == seat else 0.0)
    return rests, held


def lease_rows(school: School) -> Iterator[Row]:
    """Yield the times until the next seat in the queue holds the robot, after its holder gave it back or was lost."""
    with school.robot("seat01") as first, school.robot("seat02") as following:
        first.make_ready()
        took = []
        for _ in range(REPEATS):
            held = first.lease()
            lease.ask(following, LeaseAction.WAIT)
            took.append(handover(following, "seat02", held.close)[1])
            lease.ask(following, LeaseAction.GIVE_BACK)
        yield "lease: given back -> the next seat holds it [ms]", spread_ms(took), ""
        for what in ("killed", "frozen", "unplugged"):
            ends = [lost(school, following, what, number) for number in range(REPEATS)]
            rests, held_s = zip(*ends, strict=True)
            to_reach = "" if what == "killed" else "the session's lease is 2 s"
            yield (
                f"lease: holder {what} in a motion -> the robot rests [ms]",
                spread_ms(list(rests)),
                to_reach,
            )
            yield "  -> the next seat holds it [ms]", spread_ms(list(held_s)), to_reach


def lost(school: School, following: Robot, what: str, number: int) -> tuple[float, float]:
    """Return the times of `handover` after the holder was killed, suspended or unplugged during a motion."""
    account = accounts.load(school.path("seat03"))
    with Cable("127.0.0.1", school.classroom.router.port + 1) as cable:
        path = school.folder / "seat03-relayed.toml"
        path.write_text(msgspec.structs.replace(account, connect=f"tls/127.0.0.1:{cable.port}").text())
        with program(str(ROOT / "tests/support/student_program.py"), account=path) as holder:
            assert holder.stdin is not None
            assert holder.stdout is not None
            goal = 150 if number % 2 else -150
            for expression in (f"bool(robot('{NAME}').lease())", f"begin('{NAME}', {goal}, 20)"):
                said = ""
                deadline = time.monotonic() + PATIENCE_S
                while not said.startswith("= "):
                    assert time.monotonic() < deadline, said
                    print(expression, file=holder.stdin, flush=True)
                    said = holder.stdout.readline()
            lease.ask(following, LeaseAction.WAIT)
            time.sleep(0.3)  # the arms turn at full speed
            faults = {
                "killed": holder.kill,
                "frozen": lambda: holder.send_signal(signal.SIGSTOP),
                "unplugged": cable.unplug,
            }
            times = handover(following, "seat02", faults[what])
            lease.ask(following, LeaseAction.GIVE_BACK)
    return times


# -- restart of the router -----------------------------------------------------------------------


def restart_rows(school: School) -> Iterator[Row]:
    """Kill and restart the router while one robot moves and another rests.

    The rows are the time until all clients work again, the time until the moving robot rests, and the largest angle by
    which it moved after that, or the robot at rest moved at all.
    """
    back_s, stopped_s, moved = [], [], []
    with contextlib.ExitStack() as stack:
        robots = [
            stack.enter_context(school.robot(f"seat{number:02d}")) for number in range(1, BACK_SEATS + 1)
        ]
        others = [Robot(RESTING, "hw", client=robot.client, timeout_s=PATIENCE_S) for robot in robots]
        for number in range(REPEATS):
            for robot in (robots[0], others[1]):
                answered(robot.make_ready)
            rest = others[0].positions().commanded.short
            answered(lambda goal=150 if number % 2 else -150: robots[0].look(yaw=goal, speed=20, wait=False))  # type: ignore[misc]
            time.sleep(0.5)
            killed = time.monotonic()
            os.kill(school.router.pid, signal.SIGKILL)
            school.router.end()
            school.start_router()
            ready = time.monotonic()
            threads = [
                threading.Thread(target=answered, args=(robot.status,)) for robot in (*robots, *others)
            ]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            back_s.append(time.monotonic() - ready)
            done = [event for event in robots[1].past_events() if event.kind is EventKind.MOTION][-1]
            stopped_s.append(done.t_mono_ns / 1e9 - killed)
            where = robots[1].positions().commanded.short
            moved.append(abs(others[1].positions().commanded.short - rest))
            moved.append(abs(robots[1].positions().commanded.short - where))
    yield (
        f"router restarted: ready -> {2 * BACK_SEATS} pairs of seat and robot work [ms]",
        spread_ms(back_s),
        "< 1000",
    )
    yield "router killed -> the moving robot rests [ms]", spread_ms(stopped_s), ""
    yield "moved from then on, and the robot at rest [deg]", f"{max(moved):.2f}", "0"


def answered(ask: Callable[[], object]) -> None:
    """Call `ask` until it succeeds."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            ask()
        except BeatrixError:
            assert time.monotonic() < deadline, "no answer"
            time.sleep(0.01)
        else:
            return


def rows(folder: Path, counts: tuple[int, ...]) -> Iterator[Row]:
    """Yield all measurements."""
    school = School(folder)
    with contextlib.ExitStack() as stack:
        stack.callback(lambda: school.router.end())  # noqa: PLW0108  # the router that runs at that time
        yield "", "received/sent; age p50/p99/largest [ms]; CPU robot/seat/router [% of a core]", ""
        yield from bench_class_load.rows(school.router, school.folder, counts)
        for name in (NAME, RESTING):
            node = Served("hw_node", "--name", name, "--port", "virtual:", account=school.path(name))
            stack.callback(node.end)
        yield from stop_rows(school, counts[-1])
        yield from lease_rows(school)
        yield from restart_rows(school)
        yield from hostile_rows(school)


def main() -> None:
    """Print the rows."""
    counts = tuple(int(word) for word in sys.argv[1:]) or (1, 10, 30)
    with TemporaryDirectory() as folder:
        for figure, measured, to_reach in rows(Path(folder), counts):
            print(f"{figure:<75} {measured:<45} {to_reach}", flush=True)


if __name__ == "__main__":
    main()
