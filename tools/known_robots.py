"""Two robots with known motions and known errors, as publications and as a recording's file."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    Head,
    MotionQuery,
    Phase,
    Positions,
    Reason,
    Source,
    Steps,
    Vector3,
)
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.trajectory import Trajectory, plan
from beatrix_zenoh.recording.rows import RecordingRow, RobotRows, RobotSet
from beatrix_zenoh.recording.rrd.stream import RowStream
from beatrix_zenoh.recording.series import Floats, Recording, recording
from beatrix_zenoh.recording.verbs.compare import recorded

Arms = tuple[float, float, float]
SPEED, ACCELERATION = 60.0, 180.0
BEGAN_NS = 1_763_000_000_000_000_000
GOALS: tuple[Arms, ...] = (
    (30.0, 10.0, -20.0),
    (-20.0, 25.0, 15.0),
    (0.0, 0.0, 0.0),
    (15.0, -30.0, 10.0),
    (40.0, 20.0, -10.0),
    (-10.0, 30.0, 25.0),
    (20.0, -15.0, -30.0),
    (0.0, 0.0, 0.0),
)


@dataclass(frozen=True)
class Act:
    """A motion that a program requests, or with goal None STOP; `t` (s) is the time at the simulation."""

    t: float
    goal: Arms | None
    lead_s: float | None = 0.0
    on: str = "both"
    """both, sim or hw"""
    refused: str = ""
    """sentence of the refusal by the hardware"""
    late_s: float = 0.0
    """delay (s) of this request to the hardware alone"""


def acts(lead_s: float | None = 0.0, period_s: float = 2.2) -> list[Act]:
    """Return one motion after the other, with rests between them."""
    return [Act(1.0 + i * period_s, goal, lead_s) for i, goal in enumerate(GOALS)]


@dataclass
class Known:
    """One robot: its motions, and its errors. Each error changes positions and set points, unless it says otherwise."""

    side: str
    start: Arms = (0.0, 0.0, 0.0)
    late_s: float = 0.0
    """delay of requests and of all that follows from them"""
    stamps_late_s: float = 0.0
    """positions, not requests, have stamps that are late by this"""
    drift: float = 0.0
    """share by which the clock is fast"""
    jump: tuple[float, float] = (math.inf, 0.0)
    """the stamps of positions, not of requests, jump at a time (s) by this (s)"""
    period_s: float = 0.02
    speed: float = SPEED
    """deg/s"""
    acceleration: float = ACCELERATION
    """deg/s2"""
    change: Callable[[Floats, Floats], Floats] = lambda _t, arms: arms
    """returns the arms (deg) at times (s)"""
    slip: Callable[[Floats, Floats], Floats] = lambda _t, arms: arms
    """returns the measured arms (deg); it does not change the set points"""
    noise_deg: float = 0.0
    lost: float = 0.0
    """share of the publications that are lost"""
    seed: int = 1
    events: list[Event] = field(default_factory=list)

    def positions(self, requested: Sequence[Act], seconds: float) -> list[Positions]:
        """Carry the motions out; return the publications that arrived, and keep the events."""
        random = np.random.default_rng(self.seed)
        t = np.arange(0.0, seconds, self.period_s) + (0.007 if self.side == "hw" else 0.0)
        commanded = self.change(t, self._set_points(requested, t))
        jump_at, jump_s = self.jump
        stamps = (t + self.stamps_late_s + np.where(t >= jump_at, jump_s, 0.0)) * (1 + self.drift)
        measured = self.slip(t, commanded) + random.normal(0.0, self.noise_deg, commanded.shape)
        kept = random.random(len(t)) >= self.lost
        kept[[0, -1]] = True
        return [
            publication(i, float(stamps[i]), measured[i], commanded[i]) for i in np.flatnonzero(kept).tolist()
        ]

    def _set_points(self, requested: Sequence[Act], t: Floats) -> Floats:
        """Return the set points (n, 3), as the firmware computes them, and make the events."""
        arms = np.tile(np.array(self.start), (len(t), 1))
        now: tuple[Arms, Arms] = self.start, (0.0, 0.0, 0.0)
        way: Trajectory | None = None
        begin_s, number = 0.0, 0
        for act in sorted(requested, key=self._time):
            at = self._time(act)
            if act.on not in ("both", self.side):
                continue
            refused = act.refused if self.side == "hw" else ""
            if way is not None:
                now = way.at(at - begin_s)
                if at < begin_s + way.duration and not refused:
                    self._end(at, number, Reason.STOPPED if act.goal is None else Reason.REPLACED)
                elif at >= begin_s + way.duration and number:
                    self._end(begin_s + way.duration, number, Reason.OK)
                    number = 0
            if act.goal is not None:
                number = self._asked(act, at, refused) or number
            if refused:
                continue
            goal = act.goal or stop_at(*now, self.acceleration)
            way = plan(*now, goal, (self.speed,) * 3, self.acceleration, straight=True)
            begin_s = at
            if act.goal is None:
                number = 0
            later = t >= at
            arms[later] = np.reshape([way.at(moment - at)[0] for moment in t[later]], (-1, len(ARMS)))
        if way is not None and number:
            self._end(begin_s + way.duration, number, Reason.OK)
        return arms

    def _time(self, act: Act) -> float:
        """Return the time (s) at which this robot receives a request."""
        return act.t + (self.late_s + act.late_s + (act.lead_s or 0.0) if self.side == "hw" else 0.0)

    def _asked(self, act: Act, at: float, refused: str) -> int:
        """Add the event of a request; return the number of the motion, 0 if it was refused."""
        assert act.goal is not None
        query = MotionQuery(
            position=Vector3(*(math.radians(angle) for angle in act.goal)), lead=act.lead_s, source=Source.SDK
        )
        number = 0 if refused else len(self.events) + 1
        reason = Reason.OUT_OF_REACH if refused else Reason.OK
        self._event(at, phase=Phase.ACCEPTED, motion=number, query=query, reason=reason, message=refused)
        return number

    def _end(self, at: float, number: int, reason: Reason) -> None:
        self._event(at, phase=Phase.DONE, motion=number, query=None, reason=reason, message="")

    def _event(
        self, at: float, *, phase: Phase, motion: int, query: MotionQuery | None, reason: Reason, message: str
    ) -> None:
        stamp = round(at * (1 + self.drift) * 1e9)
        self.events.append(
            Event(
                seq=len(self.events),
                t_mono_ns=stamp,
                t_wall_ns=BEGAN_NS + stamp,
                kind=EventKind.MOTION,
                action="motion",
                seat="ana",
                phase=phase,
                reason=reason,
                message=message,
                motion=motion,
                motion_query=query,
            )
        )


def stop_at(position: Arms, velocity: Arms, acceleration: float) -> Arms:
    """Return where the arms rest after STOP (deg)."""
    short, middle, long = (p + v * abs(v) / 2 / acceleration for p, v in zip(position, velocity, strict=True))
    return short, middle, long


def publication(seq: int, t: float, arms: Floats, commanded: Floats) -> Positions:
    """Return the publication of arms (deg); the head follows from them by a rule that is easy to invert."""
    short, middle, long = (math.radians(angle) for angle in arms.tolist())
    stamp = round(t * 1e9)
    return Positions(
        seq=seq,
        t_mono_ns=stamp,
        t_wall_ns=BEGAN_NS + stamp,
        position=Vector3(short, middle, long),
        velocity=Vector3(0.0, 0.0, 0.0),
        commanded=Vector3(*(math.radians(angle) for angle in commanded.tolist())),
        steps=Steps(0, 0, 0),
        head=Head((short + middle + long) / 3, (middle - short) / 4, (long - middle) / 4),
    )


def as_recordings(
    both: Sequence[Known], requested: Sequence[Act], seconds: float, *, events: bool
) -> tuple[Recording, Recording]:
    """Return the recordings of both robots as of a live comparison."""
    sim, hw = (
        recording(known.positions(requested, seconds), 0.0, known.events if events else ()) for known in both
    )
    return sim, hw


def from_file(
    path: Path, both: Sequence[Known], requested: Sequence[Act], seconds: float, *, events: bool
) -> tuple[Recording, Recording]:
    """Write a recording as `beatrix record` does, and read it as `beatrix compare FILE` does."""
    rows: list[RecordingRow] = []
    for known in both:
        maker = RobotRows(("known", known.side), Figure())
        for positions in known.positions(requested, seconds):
            rows += maker.positions(positions, positions.t_wall_ns)
        for event in known.events if events else ():
            rows += maker.event(event, event.t_wall_ns)
    stream = RowStream(path.stem, path.stem)
    stream.to_file(path)
    stream.show(RobotSet({("known", known.side): Figure() for known in both}))
    stream.send(rows)
    if not stream.flush(30.0):
        raise OSError(f"{path} was not written within 30 s")
    stream.close()
    sim, hw = recorded(path, "known")
    return sim, hw
