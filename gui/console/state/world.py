"""States of router, robots and child programs at one moment, and what follows from them for the robots."""

from __future__ import annotations

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

import msgspec

from beatrix_zenoh.account import Account
from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import ArmAngles, Reading
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.client.lesson_reports import Row
from beatrix_zenoh.contract._generated.messages import Fault, LimitInfo, Status
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.contract.names import TEACHER

FURTHEST_DEG = 1e4
"""larger angles (deg) do not come from a robot and are ignored"""
STALE_S = 0.4
"""A robot whose newest positions are older than this (s) is silent; robots publish positions every 20 ms."""

SERVING = ("trouble.router", "trouble.simulation")
"""Failures that are over when a simulation is online."""


class LinkPhase(StrEnum):
    """Whether there is a session with the router."""

    CONNECTING = "connecting"
    NO_ROUTER = "no router"
    """no router answers; the link tries again by itself"""
    REFUSED = "refused"
    """the router does not accept the account of the window; the link tries again by itself"""
    ONLINE = "online"


class PlanPhase(StrEnum):
    """Phase of a motion of both robots."""

    TRYING = "trying"
    """previewed on a copy of the simulation"""
    LEADING = "leading"
    """the simulation moves; the hardware motion was not sent yet"""
    SENT = "sent"
    """the hardware motion was sent, too"""


@dataclass(frozen=True)
class PlanProgress:
    """A motion of both robots under way."""

    phase: PlanPhase
    duration_s: float = 0.0
    lead_s: float = 0.0
    countdown_s: float = 0.0
    """time until the link sends the motion to the hardware"""
    path: MotionPath | None = None
    """the previewed path, degrees"""
    apart_deg: float = 0.0
    """distance of the hardware from the simulation at the preview; 0: none, so the path holds for the hardware"""
    alike: bool = True
    """whether both robots run with the same values"""


@dataclass(frozen=True)
class Trouble:
    """Why a program of this window did not start or has failed, or why a router or account cannot be used."""

    key: str
    """a text of the faces"""
    code: str = ""
    """exit code, or name of the signal; a slot of the text"""
    detail: str = ""
    """last lines of its output, or the error of the system, in English"""
    slots: Mapping[str, str] = field(default_factory=dict)
    """further slots of the text"""


@dataclass(frozen=True)
class UsbPort:
    """A serial port of this computer."""

    device: str
    """for example `/dev/ttyACM0` or `COM4`"""
    title: str
    """what the system calls it"""
    board: bool
    """whether it is the board of a robot"""


@dataclass(frozen=True)
class RecordingProgress:
    """A recording, running or finished."""

    file: Path
    running: bool
    seconds: float
    trouble: Trouble | None = None
    """why the recording did not begin or has ended by itself; None: no failure"""
    ending: bool = False
    """whether the user has ended it and the recorder still completes the file"""


@dataclass(frozen=True)
class Person:
    """The simulated person: the middle between the eyes (m from the neck's centre)."""

    x: float
    y: float
    z: float
    speaks: bool = False


@dataclass(frozen=True)
class MusicProgress:
    """The music beside the sequence."""

    file: str = ""
    """path; empty: there is none"""
    ready: bool = False
    """whether it was read"""
    beat_s: float = 0.0
    """time from beat to beat; 0: no steady beat is heard"""
    trouble: Trouble | None = None
    """why it cannot be read or played"""


@dataclass(frozen=True)
class PictureProgress:
    """A film under way, and the newest photo or film."""

    seconds: float | None = None
    """duration of the film that runs; None: none runs"""
    writing: bool = False
    """whether a photo or film is being drawn"""
    file: Path | None = None
    trouble: Trouble | None = None
    """why the last one was not written"""


@dataclass(frozen=True)
class ProgramProgress:
    """The Python program that was started last."""

    file: Path = Path()
    running: bool = False
    output: tuple[str, ...] = ()
    """its last lines"""
    line: int = 0
    """the line at which it has failed; 0: none"""
    sides: tuple[str, ...] = ()
    """its arguments: a shipped program sees and hears with the first robot"""

    def runs(self, file: Path) -> bool:
        """Return whether this program runs."""
        return self.running and self.file == file


@dataclass(frozen=True)
class CodeProgress:
    """The program in the code panel."""

    presses: Path = Path()
    """where the program of the presses is written before it runs"""
    file: Path | None = None
    """its file; None: it is the program of the presses"""
    text: str = ""
    """of the file"""
    opens: int = 0
    """how often the user has opened a program"""
    trouble: Trouble | None = None
    """why the file cannot be read or written"""


@dataclass(frozen=True)
class OwnGesture:
    """A gesture of the user."""

    name: str
    emoji: str
    """empty: it has none"""
    text: str
    """of its file"""
    wrong: WrongUsage | None = None
    """why it cannot be played; None: it can"""
    common: bool = False
    """whether all pages of a server have it, so that none of them changes it"""


class CheckReport(msgspec.Struct, frozen=True):
    """A line of `beatrix lesson watch --json`: a check that has begun or ended, or why there is none."""

    lesson: str = ""
    outcome: str = ""
    """`checks`, `passed`, `not_yet` or `not_measurable`; empty: `message` says why there was no check"""
    asked: str = ""
    found: str = ""
    message: str = ""
    picture: str = ""
    """file with what was asked and done (SVG); empty: none"""


@dataclass(frozen=True)
class LessonRun:
    """Lessons of the folder in which the window was started."""

    passed: frozenset[str] = frozenset()
    """names of the lessons whose programs have passed"""
    programs: Mapping[str, str] = field(default_factory=dict)
    """by lesson that was started: path of the program"""
    watched: int = 0
    """number of the lesson whose program is checked at each save; 0: none"""
    report: CheckReport = field(default_factory=CheckReport)
    """the newest"""
    hint: str = ""
    """the last hint; empty: none was asked for"""
    note: str = ""
    """why a start or a hint is refused; empty: it is not"""


@dataclass(frozen=True)
class World:
    """Everything that a view is made from, at one moment; degrees and seconds unless a name contains another unit."""

    now_s: float
    """monotonic clock"""
    phase: LinkPhase
    endpoint: str
    """address of the router, for example tcp/127.0.0.1:7447"""
    seat: str
    robot: str
    """name of the robot that the window shows"""
    sim: RobotState
    hw: RobotState
    names: tuple[str, ...] = ()
    """robots online, by name"""
    trouble: str = ""
    """why there is no session or no router; empty if both exist"""
    latency_s: Mapping[str, float | None] = field(default_factory=dict)
    """by side: round trip of the last query; None: it was not answered"""
    plan: PlanProgress | None = None
    recording: RecordingProgress | None = None
    starting: bool = False
    """whether this window is starting a simulation"""
    connecting: bool = False
    """whether this window is starting the program of the hardware"""
    own_hardware: bool = False
    """whether a program of the hardware of this window is running"""
    ports: tuple[UsbPort, ...] | None = None
    """serial ports of this computer, when the user has asked for them; None: not known yet"""
    account: Account | None = None
    """None: the window has no account"""
    choosing: bool = False
    """whether another router or account is being checked"""
    router_trouble: Trouble | None = None
    """why the last choice of a router or account is not used; None: it is, or there was none"""
    child_trouble: Trouble | None = None
    """why a router, simulation or viewer of this window did not start or has failed; None: no failure"""
    playing: str = ""
    """title of the current play; empty: none"""
    playing_pose: int = -1
    """number of the pose of the sequence that is being played, from 0; -1: none"""
    gestures: tuple[OwnGesture, ...] = ()
    """those of the user, by name"""
    program: ProgramProgress = ProgramProgress()
    code: CodeProgress = CodeProgress()
    picture: PictureProgress = PictureProgress()
    music: MusicProgress = MusicProgress()
    block: str | None = None
    """id of the block that runs, empty at the beginning of a program of blocks; None: no such program runs"""
    who: str = ""
    """the seat, if programs and command lines would choose another one by themselves; empty: they would not"""
    wall_s: float = 0.0
    """wall clock at `now_s`, since 1970; 0: unknown"""
    session: str = ""
    """id of this window's Zenoh session, as in events; empty: unknown"""
    limits: LimitInfo | None = None
    """limits that the robot reports; None: unknown, so the defaults are shown"""
    seats: tuple[str, ...] = ()
    """seats that are connected to the router"""
    robots: tuple[RobotState, ...] = ()
    """all robots online, while the page of the class is shown"""
    reports: tuple[Row, ...] | None = None
    """reports of lessons, by seat and lesson, while the teacher's page of the class is shown; None: not read yet"""
    reports_failed: bool = False
    """whether the last read of the reports failed, so that they may be old"""
    lesson: LessonRun = field(default_factory=LessonRun)
    levels: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """by side, while the window listens: loudness of the left and the right ear (dB), -120 is silence"""
    person: Person | None = None
    """None: not asked for, or there is no simulation"""

    @property
    def is_teacher(self) -> bool:
        """Whether this window has the teacher's seat."""
        return self.seat == TEACHER

    @property
    def today(self) -> dt.date:
        """The present day in UTC, as in certificates."""
        return dt.datetime.fromtimestamp(self.wall_s, dt.UTC).date()

    def shown(self, seat: str) -> str:
        """Return a seat, for the teacher of a class with the name of its pupil."""
        return seat if self.account is None else self.account.shown(seat)

    def side(self, side: str) -> RobotState:
        """Return the state of `sim` or `hw`."""
        return self.sim if side == "sim" else self.hw


def online(world: World, side: str) -> bool:
    """Return whether a request can reach a robot: there is a router, and the robot's token."""
    return world.phase is LinkPhase.ONLINE and world.side(side).presence is not Presence.ABSENT


def fault_of(status: Status) -> Fault:
    """Return the fault of a robot; BOARD_LOST if there is none and the board is not connected."""
    if status.fault is Fault.NONE and not status.board.connected:
        return Fault.BOARD_LOST
    return status.fault


def silent(robot: RobotState) -> bool:
    """Return whether the positions or the status of the robot are missing or too old."""
    age_s = robot.positions_age_s
    return robot.status is None or robot.positions is None or age_s is None or age_s > STALE_S


def kept(world: World, side: str) -> Reading | None:
    """Return the last angles (deg) of a robot that is online, even if they are old; None if they are unknown."""
    found = world.side(side).reading if online(world, side) else None
    angles = () if found is None else (*found.arms, *found.commanded, *found.head)
    return found if all(abs(angle) < FURTHEST_DEG for angle in angles) else None


def reading(world: World, side: str) -> Reading | None:
    """Return the angles of a robot in degrees; None if they are unknown or too old."""
    return None if silent(world.side(side)) else kept(world, side)


def commanded(world: World, sides: tuple[str, ...]) -> ArmAngles | None:
    """Return the set point of the arms (deg) of the first robot that reports it; None if none does."""
    for side in sides:
        if (found := reading(world, side)) is not None:
            return found.commanded
    return None


def news(world: World) -> dict[str, Trouble | Path]:
    """Return failures of recording and child programs, and a recording that has ended, by the key of their text.

    A simulation that could not be started is none while another program, such as `beatrix up`, has started it.
    """
    found: dict[str, Trouble | Path] = {}
    recording, failed = world.recording, world.child_trouble
    if recording is not None and recording.trouble is not None:
        found["record.trouble"] = recording.trouble
    if failed is not None and not (world.sim.presence is Presence.ONLINE and failed.key in SERVING):
        found["child.trouble"] = failed
    if recording is not None and not recording.running:
        found["record.saved"] = recording.file
    if (picture := world.picture.trouble or world.picture.file) is not None:
        found["picture.trouble" if world.picture.trouble else "picture.saved"] = picture
    if world.music.trouble is not None:
        found["music.trouble"] = world.music.trouble
    return found
