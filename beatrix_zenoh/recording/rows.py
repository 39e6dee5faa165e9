"""The rows of a recording, the names of its entities, and what makes rows of the publications; independent of Rerun."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from beatrix_zenoh.body.figure import Figure, Quaternion
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    Fault,
    FollowState,
    Head,
    Phase,
    Positions,
    Reason,
    Status,
    Vector3,
)
from beatrix_zenoh.contract.codec import encode_json
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.contract.sentences.events import sentence
from beatrix_zenoh.motion.rotation import rotation_of

RECORDER = "_recorder"
"""Root of the recorder's own entities; no robot can have this name."""
NOTES = f"{RECORDER}/notes"
"""Entity of the users' notes as lines."""
MARK = f"{RECORDER}/note"
"""Entity of the users' notes as bars on the time line."""


@dataclass(frozen=True)
class RecordingRow:
    """One value of an entity; `time_ns` is the source's time by the clock of the recording computer, since 1970."""

    path: str
    time_ns: int


@dataclass(frozen=True)
class Numbers(RecordingRow):
    """Numbers of a plot: deg, deg/s or counts."""

    values: tuple[float, ...]
    robot_ns: int | None = None
    """the time by the robot's own wall clock (ns since 1970): the arms have it; all rows of an entity, or none"""


@dataclass(frozen=True)
class BodyTurn(RecordingRow):
    """Orientation of a body in its parent's frame."""

    quaternion: Quaternion


@dataclass(frozen=True)
class Line(RecordingRow):
    """A line of a log."""

    text: str
    level: str
    json: str = ""
    """the event of this line as JSON; empty: the line is no event"""


@dataclass(frozen=True)
class Bar(RecordingRow):
    """A state that lasts until the next one."""

    state: str


@dataclass(frozen=True)
class Frame(RecordingRow):
    """A camera's picture."""

    jpeg: bytes


@dataclass(frozen=True)
class SoundRow(RecordingRow):
    """A block of sound from both microphones."""

    pcm: bytes
    """int16, little-endian, left and right by turns, as published"""
    rate: int
    """frames per second"""
    seq: int
    """number of the block; a gap means lost blocks"""


def of_robot(place: Place, *parts: str) -> str:
    """Return the path of an entity of one robot, for example `bea/sim/arms`."""
    return "/".join((*place, *parts))


def of_model(place: Place, body: str) -> str:
    """Return the Rerun entity path of a body of a robot's model."""
    return of_robot(place, "model", body)


def of_difference(robot: str, what: str) -> str:
    """Return the path of the difference between hardware and simulation; `what` is `arms` or `head`."""
    return f"{robot}/difference/{what}"


Say = Callable[[str], None]
"""A function that shows a sentence to the user."""


@dataclass(frozen=True)
class RobotSet:
    """The robots found so far, and those that have sent pictures or sound."""

    robots: Mapping[Place, Figure]
    with_pictures: frozenset[Place] = frozenset()
    with_sound: frozenset[Place] = frozenset()

    @property
    def names(self) -> list[str]:
        """Names of the robots, without duplicates."""
        return sorted({name for name, _ in self.robots})

    def sides(self, name: str) -> list[Place]:
        """Return the sides of one robot, the simulation first."""
        return [(name, side) for side in SIDES if (name, side) in self.robots]


GRID_NS: Final = 20_000_000
"""Period of the grid, equal to that of positions at 50 Hz; grid points are whole multiples of it."""
GAP_NS: Final = 100_000_000
"""Samples further apart than this are not interpolated."""
WAITING: Final = 250
"""Samples of one side (5 s) that are kept until samples of the other side arrive."""

Angles = tuple[float, ...]


class Difference:
    """Calculates hardware minus simulation (deg) from their samples, for each grid point that both cover.

    Between two samples of a side its angles are interpolated linearly.
    """

    def __init__(self) -> None:
        self._samples: dict[str, deque[tuple[int, Angles]]] = {side: deque(maxlen=WAITING) for side in SIDES}
        self._next_ns = 0

    def add(self, side: str, time_ns: int, angles: Angles) -> Iterator[tuple[int, Angles]]:
        """Add a sample (deg); yield times and differences that are known now. Samples out of order are ignored."""
        samples = self._samples[side]
        if samples and time_ns <= samples[-1][0]:
            return
        samples.append((time_ns, angles))
        sim, hw = self._samples["sim"], self._samples["hw"]
        if not sim or not hw:
            return
        self._next_ns = max(self._next_ns, -(-max(sim[0][0], hw[0][0]) // GRID_NS) * GRID_NS)
        last_ns = min(sim[-1][0], hw[-1][0])
        while self._next_ns <= last_ns:
            first, second = at(sim, self._next_ns), at(hw, self._next_ns)
            if first is not None and second is not None:
                apart = ((b - a + 180.0) % 360.0 - 180.0 for a, b in zip(first, second, strict=True))
                yield self._next_ns, tuple(apart)
            self._next_ns += GRID_NS


def at(samples: deque[tuple[int, Angles]], time_ns: int) -> Angles | None:
    """Return the angles (deg) at a time; None before the first sample or inside a gap.

    Drops the samples that neither this time nor later times need.
    """
    while len(samples) > 1 and samples[1][0] <= time_ns:
        samples.popleft()
    (before_ns, before), (after_ns, after) = samples[0], samples[min(1, len(samples) - 1)]
    if time_ns < before_ns or after_ns - before_ns > GAP_NS:
        return before if time_ns == before_ns else None
    part = (time_ns - before_ns) / (after_ns - before_ns) if after_ns > before_ns else 0.0
    return tuple(a + part * (b - a) for a, b in zip(before, after, strict=True))


STILL: Final = 5e-5
"""If all components of a quaternion change by at most this (0.006 deg), there is no new row."""


class BarState(StrEnum):
    """A robot's state, shown as a coloured bar."""

    DISABLED = "disabled"
    ENABLED = "enabled"
    READY = "ready"
    MOVING = "moving"
    FOLLOWING = "follows hardware"
    PARTED = "parted from hardware"
    STOPPED = "stopped"
    EMERGENCY = "emergency stop"
    FAULT = "fault"
    LOST = "lost"


FOLLOWING = {
    FollowState.APPROACHING: BarState.FOLLOWING,
    FollowState.FOLLOWING: BarState.FOLLOWING,
    FollowState.PARTED: BarState.PARTED,
}
"""States of a simulation that follows the hardware."""


class RobotRows:
    """Makes the rows of one robot; bodies and the state get a new row only if they change."""

    def __init__(self, place: Place, figure: Figure) -> None:
        self.place, self.figure = place, figure
        self._turns: dict[str, Quaternion] = {}
        self._state: BarState | None = None
        self._status: Status | None = None
        self._stopped = False
        self._since_ns = 0
        self.angles: tuple[float, ...] = ()
        """Arms and head of the newest positions (deg)."""
        self._clock: tuple[int, float, float] | None = None
        self._written_ns: int | None = None
        self._repeats = 0
        self._repeats_row: int | None = None

    def clock(self, time_ns: int, offset_s: float, bound_s: float) -> Iterator[RecordingRow]:
        """Yield a measured offset of the robot's clock and its largest error (s); each new file begins with the last."""
        self._clock = time_ns, offset_s, bound_s
        yield Numbers(of_robot(self.place, "clock"), time_ns, (offset_s, bound_s))

    def repeats(self, positions: Positions, *, stale: bool) -> bool:
        """Return whether positions only repeat those of the last rows: the node had no new telemetry.

        They get no rows, because tools that merge rows of one time would lose sequence numbers; the next rows contain
        their number. `stale`: they repeat others of long ago.
        """
        repeated = stale or (positions.repeated and positions.t_mono_ns == self._written_ns)
        self._repeats += repeated
        return repeated

    def positions(self, positions: Positions, time_ns: int) -> Iterator[RecordingRow]:
        """Yield the numbers of a publication in deg and deg/s, its sequence number, and the bodies that have turned.

        `repeats` is the number of publications just before that only repeated the rows before them; without a row it
        is 0, and a 0 after another number has a row.
        """
        arms, measured = positions.position, arms_deg(positions.position)
        yield Numbers(of_robot(self.place, "arms"), time_ns, measured, positions.t_wall_ns)
        numbers = {
            "commanded": arms_deg(positions.commanded),
            "head": head_deg(positions.head),
            "velocity": arms_deg(positions.velocity),
            "seq": (float(positions.seq),),
        }
        if self._repeats or self._repeats_row != 0:
            numbers["repeats"] = (float(self._repeats),)
        self._written_ns, self._repeats_row, self._repeats = positions.t_mono_ns, self._repeats, 0
        self.angles = measured + numbers["head"]
        body = positions.head
        if positions.head_measured is not None:
            body = positions.head_measured
            numbers["head_measured"] = head_deg(body)
        for what, values in numbers.items():
            yield Numbers(of_robot(self.place, what), time_ns, values)
        rotation = rotation_of(body.yaw, body.pitch, body.roll)
        for path, turn in self.figure.rotations((arms.x, arms.y, arms.z), rotation).items():
            if moved(self._turns.get(path), turn):
                self._turns[path] = turn
                yield BodyTurn(of_model(self.place, path), time_ns, turn)

    def begin_again(self) -> list[RecordingRow]:
        """Let the next publications repeat all bodies and the state, for a new file or viewer; return the clock again."""
        self._turns.clear()
        self._state = self._repeats_row = None
        return [] if self._clock is None else [*self.clock(*self._clock)]

    def status(self, status: Status, time_ns: int) -> Iterator[RecordingRow]:
        """Yield the state if it has changed."""
        self._status = status
        if status.moving or not status.enabled:
            self._stopped = False
        yield from self._changed_to(self._state_now(), time_ns)

    def event(self, event: Event, time_ns: int) -> Iterator[RecordingRow]:
        """Yield the event as a line, and the state if a STOP changes it."""
        text = f"{clock(time_ns)}  {self.place[0]} {self.place[1]}:  {sentence(event)}"
        yield Line(
            of_robot(self.place, "events"), time_ns, text, level_of(event), encode_json(event).decode()
        )
        if event.kind is EventKind.STOP and event.action != "EMERGENCY_STOP":
            self._stopped = True
            yield from self._changed_to(self._state_now(), time_ns)

    def lost(self, time_ns: int) -> Iterator[RecordingRow]:
        """Yield the state LOST, once: the positions of the robot have ended."""
        yield from self._changed_to(BarState.LOST, time_ns)

    def back(self, time_ns: int) -> Iterator[RecordingRow]:
        """Yield the present state of a robot that was lost and publishes positions again."""
        if self._state is BarState.LOST and self._status is not None:
            yield from self._changed_to(self._state_now(), time_ns)

    def _state_now(self) -> BarState:
        if self._status is None:
            return BarState.STOPPED if self._stopped else BarState.READY
        state = state_of(self._status)
        return BarState.STOPPED if self._stopped and state is BarState.READY else state

    def _changed_to(self, state: BarState, time_ns: int) -> Iterator[RecordingRow]:
        if state is not self._state:
            self._state = state
            # The event of a STOP may arrive after the status that it has caused, with an earlier time. The viewer shows
            # the state with the latest time, so the times must ascend.
            self._since_ns = max(time_ns, self._since_ns + 1)
            yield Bar(of_robot(self.place, "state"), self._since_ns, state)


def moved(before: Quaternion | None, now: Quaternion) -> bool:
    """Return whether a body has turned since its last row."""
    return before is None or any(abs(a - b) > STILL for a, b in zip(before, now, strict=True))


def state_of(status: Status) -> BarState:
    """Return the state that follows from a status."""
    if status.fault is Fault.EMERGENCY:
        return BarState.EMERGENCY
    if status.fault is Fault.BOARD_LOST or not status.board.connected:
        return BarState.LOST
    if status.fault is not Fault.NONE:
        return BarState.FAULT
    if not status.enabled:
        return BarState.DISABLED
    if not status.calibrated:
        return BarState.ENABLED
    return FOLLOWING.get(status.following) or (BarState.MOVING if status.moving else BarState.READY)


def arms_deg(vector: Vector3) -> tuple[float, float, float]:
    """Return the short, middle and long component of an angle or velocity in deg or deg/s."""
    return math.degrees(vector.x), math.degrees(vector.y), math.degrees(vector.z)


def head_deg(head: Head) -> tuple[float, float, float]:
    """Return yaw, pitch and roll (deg)."""
    return math.degrees(head.yaw), math.degrees(head.pitch), math.degrees(head.roll)


def clock(time_ns: int) -> str:
    """Return the time of day in UTC, as on the axes of the viewer."""
    moment = time.strftime("%H:%M:%S", time.gmtime(time_ns // 1_000_000_000))
    return f"{moment}.{time_ns // 1_000_000 % 1000:03d}"


def level_of(event: Event) -> str:
    """Return the log level of an event.

    This is the level of a log event, ERROR for STOP, WARN for refusals, warnings, and events of board and router, else
    INFO.
    """
    if event.kind is EventKind.LOG:
        return event.action if event.action in ("INFO", "DEBUG", "ERROR") else "WARN"
    if event.kind is EventKind.STOP:
        return "ERROR"
    bad = event.reason is not Reason.OK and event.phase is not Phase.DONE
    return "WARN" if bad or event.kind in (EventKind.WARNING, EventKind.BOARD, EventKind.ROUTER) else "INFO"
