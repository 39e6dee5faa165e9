"""The stage of an observed check: a router and simulations of its own, on free ports, and what they publish."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.degrees import reading
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Subscription
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Positions, Status
from beatrix_zenoh.lessons.measures import Curve, HeadCurves
from beatrix_zenoh.lessons.phrases import Phrase, Still, Tell, busy, phrase
from beatrix_zenoh.lessons.sandbox import PREFIX, at_home, scratch
from beatrix_zenoh.processes import Child, Supervisor, free_port
from beatrix_zenoh.settings import Settings

START_S = 90.0
"""Longest start of the simulations (s); a computer that needs longer is too busy."""
ANSWER_S = 10.0
GAP_S = 0.1
"""Longest gap between two positions (s) of a run that can fail."""
LONGEST_GAP_S = 0.3
"""Longest gap of a run that can pass: what happened in a gap of 0.1 s was hardly more than what was seen around it."""
PAUSE_S, PAUSE_DEG = 0.3, 9.0
"""If a simulation stood still for longer (s), its time continues from then (STALL_S of sim_node/body.py). If the set
points of its arms have moved by less (deg) meanwhile, the gap hides no more motion than LONGEST_GAP_S at 30 deg/s."""
SLOWEST = 0.9
"""Smallest real-time factor of a run that can fail."""
POLL_S = 0.02
ROBOT = "bea1"
"""Name of the simulation, as the pages write it: a program that is copied from them finds it."""
SEAT = "check"
"""Seat of the check itself."""
PUPIL = "pupil"
"""Seat of the program."""


@dataclass(frozen=True)
class Seen(HeadCurves):
    """What one robot published during a run: times (s) from the program's start, angles in degrees."""

    commanded: Curve
    """set point of the arms, shape (n, 3)"""
    speed: Curve
    """of the arms (deg/s), shape (n, 3)"""
    events: list[Event]
    """requests and their outcomes, in their order"""
    event_times: Curve
    """of `events`"""
    doubt: Phrase | None = None
    """why a figure that is not met may be the fault of this computer; None: it was fast enough"""

    @property
    def motions(self) -> list[tuple[float, Event]]:
        """Motions that the program has asked for, whatever seat it has named, and their ends, with the times (s)."""
        return [
            (float(time), event)
            for time, event in zip(self.event_times, self.events, strict=True)
            if event.kind is EventKind.MOTION and event.seat not in ("", SEAT)
        ]


def hidden_s(t: Curve, seq: npt.NDArray[np.int64], commanded: Curve) -> float:
    """Return the longest time (s) between two positions in which the robot may have moved without being seen.

    Args:
        t: times of the positions (s).
        seq: their sequence numbers: a missing one was published, and lost on the way.
        commanded: set points of the arms (deg), shape (n, 3).
    """
    gaps, moved = np.diff(t), np.abs(np.diff(commanded, axis=0)).max(axis=1)
    paused = (gaps > PAUSE_S) & (moved < PAUSE_DEG) & (np.diff(seq) == 1)
    return float(gaps[~paused].max(initial=0.0))


def pace(seen: dict[str, Seen]) -> dict[str, object]:
    """Return how many motions a program has asked for, and how much time (s) was between two of them."""
    asked = [
        (at_s, event.count)
        for one in seen.values()
        for at_s, event in one.motions
        if event.phase == "accepted"
    ]
    count = sum(number for _, number in asked)
    times = [at_s for at_s, _ in asked]
    every_s = (max(times) - min(times)) / (count - 1) if count > 1 else 0.0
    return {"count": count, "every": every_s}


class RobotWatch:
    """Everything that one robot publishes, from now on."""

    def __init__(self, client: Client, robot: str) -> None:
        self.robot = Robot(robot, "sim", client=client, timeout_s=ANSWER_S)
        self._positions: Subscription[Positions] = subscription.positions(client, robot, "sim")
        self._status: Subscription[Status] = subscription.status(client, robot, "sim")
        self._events: Subscription[Event] = subscription.events(client, robot, "sim")
        self._seen: list[Positions] = []
        self._factors: list[float] = []
        self._happened: list[Event] = []
        self._counts = True

    def first(self, timeout_s: float) -> int:
        """Forget what has been seen, and return the time of the next position (ns, clock of the robot).

        Raises NoAnswer if none arrives within `timeout_s` (s).
        """
        self.begin()
        return self._positions.next(timeout_s).t_mono_ns

    def close(self) -> None:
        """End the subscriptions; what has been seen stays."""
        for subscription_ in (self._positions, self._status, self._events):
            subscription_.close()

    def take(self) -> None:
        """Keep what has arrived since the last call."""
        if not self._counts:
            return
        self._seen += self._positions.take()
        self._happened += self._events.take()
        self._factors += [status.plant.real_time_factor for status in self._status.take() if status.plant]

    def begin(self) -> None:
        """Forget what has been seen so far."""
        self._counts = True
        self.take()
        self._seen, self._factors, self._happened = [], [], []

    def pause(self) -> None:
        """Keep what has been seen so far, and nothing that comes after it."""
        self.take()
        self._counts = False

    def end(self, began_ns: int) -> Seen:
        """Return what was seen since `begin`; times count from `began_ns` (monotonic clock).

        Raises NotMeasurable if this computer was too busy for any figure to mean anything.
        """
        self.take()
        seen = [positions for positions in self._seen if positions.t_mono_ns >= began_ns]
        t = (np.array([positions.t_mono_ns for positions in seen], dtype=float) - began_ns) / 1e9
        if len(t) < 2:
            raise busy(phrase("no_positions"))
        readings = [reading(positions) for positions in seen]
        commanded = np.array([one.commanded for one in readings])
        gap, factor = float(np.diff(t).max()), min(self._factors, default=1.0)
        doubt: Phrase | None = None
        if gap > GAP_S:
            doubt = phrase("gap", ms=gap * 1000, allowed=GAP_S * 1000)
        elif factor < SLOWEST:
            doubt = phrase("slow", factor=factor)
        if hidden_s(t, np.array([positions.seq for positions in seen]), commanded) > LONGEST_GAP_S:
            raise busy(phrase("gap", ms=gap * 1000, allowed=GAP_S * 1000))
        happened = [event for event in self._happened if event.t_mono_ns >= began_ns]
        return Seen(
            t,
            head=np.array([one.head for one in readings]),
            arms=np.array([one.arms for one in readings]),
            commanded=commanded,
            speed=np.array([one.velocity for one in readings]),
            events=happened,
            event_times=(np.array([event.t_mono_ns for event in happened], dtype=float) - began_ns) / 1e9,
            doubt=doubt,
        )


@dataclass
class Stage:
    """A router, simulations that are ready, and a client that watches them: see `open_stage`."""

    names: tuple[str, ...]
    endpoint: str
    _tell: Tell
    _supervisor: Supervisor
    _running: ExitStack
    watches: dict[str, RobotWatch] = field(default_factory=dict)

    def wait(self, child: Child) -> None:
        """Wait until a child is ready; raises NotMeasurable after START_S, Refused if it has ended."""
        deadline_s = time.monotonic() + START_S
        still = Still(self._tell, "still_starts", START_S)
        while not child.ready:
            self._supervisor.check()
            if time.monotonic() > deadline_s:
                raise busy(phrase("not_ready", seconds=START_S))
            still.look()
            time.sleep(POLL_S)

    def robot(self, name: str = "", who: str = SEAT) -> Robot:
        """Return a robot of the stage for another seat; its session ends with the stage."""
        name = name or self.names[0]
        client = self._running.enter_context(Client(Settings(name, self.endpoint, who)))
        return Robot(name, "sim", client=client, timeout_s=ANSWER_S)

    @contextmanager
    def counting(self) -> Iterator[None]:
        """Let only what the robots do during this block count, and only gaps in it; without it, the whole run counts."""
        for watch in self.watches.values():
            watch.begin()
        yield
        for watch in self.watches.values():
            watch.pause()

    @contextmanager
    def recorded(self, path: Path) -> Iterator[None]:
        """Record the robots to a file during a block; an older file is deleted."""
        path.unlink(missing_ok=True)
        recorder = self._supervisor.start("recorder", "record", str(path), "--connect", self.endpoint)
        self.wait(recorder)
        try:
            yield
        finally:
            self._supervisor.finish(recorder)


@contextmanager
def open_stage(
    names: Sequence[str] = (ROBOT,),
    path: str = "still",
    robot_file: Path | None = None,
    tell: Tell = lambda _: None,
) -> Iterator[Stage]:
    """Run a stage with robots of these names during a block.

    Args:
        names: of the robots.
        path: of the person in front of them.
        robot_file: values of other robots.
        tell: is called with sentences about a start that takes long.
    """
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with ExitStack() as running:
        running.callback(zbus.open_router(endpoint).close)
        # The router of a check has no accounts, and a robot of the user that is frozen freezes no check.
        own = {"BEATRIX_ACCOUNT": "", **at_home(running.enter_context(scratch()))}
        supervisor = running.enter_context(Supervisor(own, PREFIX))
        stage = Stage(tuple(names), endpoint, tell, supervisor, running)
        robots = [word for name in names for word in ("--name", name)]
        values = ("--robot-file", str(robot_file)) if robot_file else ()
        words = ("--connect", endpoint, "--ready", "--target", path, *values)
        stage.wait(supervisor.start("simulation", "sim", *robots, *words, robots=len(names)))
        client = running.enter_context(Client(Settings(names[0], endpoint, SEAT)))
        stage.watches |= {name: RobotWatch(client, name) for name in names}
        yield stage


Stages = Callable[[Sequence[str], str, Path | None, Tell], AbstractContextManager[Stage]]
"""What runs a stage during a block; arguments as of `open_stage`."""
