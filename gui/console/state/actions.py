"""Actions, which `link.Link` carries out, and the `Outcome`s that it reports for each action with a row.

Each action is an intent, too: buttons report actions for which nothing is left to decide, or only the row.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

from beatrix_zenoh.client import Place
from beatrix_zenoh.client.choreography import ArmPose
from beatrix_zenoh.contract._generated.messages import (
    Command,
    Detail,
    LeaseAction,
    MotionQuery,
    PoseQuery,
    Reason,
)
from gui.console.state.intents import Intent, Side

NEW: Final = 0
"""Row of a request that a button reports; the history gives it a number."""


class Action(Intent, frozen=True):
    """Base class of all actions."""


class Send(Action, frozen=True):
    """A motion; for two robots it is previewed, then made by the simulation, and `lead_s` later by the hardware."""

    row: int
    """number of the request's row in the history"""
    query: MotionQuery | PoseQuery
    sides: tuple[str, ...]
    """`sim`, `hw`, or `sim` and `hw`"""
    lead_s: float = 0.0


class Hold(Action, frozen=True):
    """Move some robots while a button is held; repeated as a heartbeat, without which they stop within 0.5 s."""

    row: int
    """also the number of the press"""
    part: str
    """an arm, or `all`"""
    sign: int
    speed: float
    """deg/s"""
    sides: tuple[str, ...]


class Release(Action, frozen=True):
    """End a hold."""

    row: int


class SendCommand(Action, frozen=True):
    """A command for some robots."""

    row: int
    command: Command
    value: bool
    sides: tuple[str, ...]


class MakeReady(Action, frozen=True):
    """Enable and calibrate one robot, unless that is done already."""

    side: Side
    row: int = NEW


class SendStop(Action, frozen=True):
    """STOP or EMERGENCY_STOP for both robots, or for all robots at the router; sent on a thread of its own."""

    row: int
    everywhere: bool = False
    emergency: bool = False


class AskLease(Action, frozen=True):
    """Take one robot of the shown name, wait for it, or give it back."""

    action: LeaseAction
    """TAKE, WAIT or GIVE_BACK"""
    side: Side
    row: int = NEW


class Govern(Action, frozen=True):
    """A lease query to one robot or several, sent to all of them at the same time."""

    row: int
    action: LeaseAction
    places: tuple[Place, ...] = ()
    """name and side of each robot; empty: all robots online"""
    speed: float = 0.0
    """speed limit (rad/s), for LIMIT only; 0: no limit"""
    seat: str = ""
    """for MUTE and UNMUTE only"""


class WatchClass(Action, frozen=True):
    """Begin or end reading the states of all robots, and the reports of lessons."""

    on: bool


class SendNow(Action, frozen=True):
    """Send the waiting motion of both robots to the hardware now."""


class Abort(Action, frozen=True):
    """End the motion of both robots; the hardware stays unmoved, or stops if it moves already."""


POSES = "poses"
"""The name of a play that has no file."""
LARGEST_BYTES = 1 << 19
"""Largest size of a file to play or to open (bytes): about 15 000 lines. Checking them takes seconds, in which STOP
cannot end the play."""


class Play(Action, frozen=True):
    """Play a file, or poses that begin at their times."""

    row: int
    sides: tuple[str, ...]
    file: Path | None = None
    """None: the gesture or the poses are played"""
    poses: tuple[ArmPose, ...] = ()
    again: tuple[ArmPose, ...] = ()
    """played after `poses`, over and over until a newer request or STOP; empty: the play ends"""
    lead_s: float = 0.0
    gesture: str = ""
    """name of a shipped choreography; empty: file or poses"""

    @property
    def title(self) -> str:
        """The name of the gesture or of the file, or POSES."""
        return self.gesture or (POSES if self.file is None else self.file.stem)


class RunBlocks(Action, frozen=True):
    """Run a program of blocks."""

    row: int
    sides: tuple[str, ...]
    program: str
    """as of the intent"""
    lead_s: float = 0.0


class EndBlocks(Action, frozen=True):
    """End the program of blocks."""


class FollowFace(Action, frozen=True):
    """Start the program that follows a face."""

    row: int
    sides: tuple[str, ...]
    """the robots that move; the first one's left eye sees"""


class EndFollowing(Action, frozen=True):
    """End the program that follows a face."""


class RunLesson(Action, frozen=True):
    """Run a verb of `beatrix lesson` as a child process."""

    verb: Literal["start", "hint", "watch", "end"]
    """`end` ends a watch"""
    number: int = 0
    """of the lesson"""
    language: str = "en"
    """of its texts, for a start"""


class WriteFile(Action, frozen=True):
    """Write or replace a file; the outcome names no robot."""

    row: int
    file: Path
    content: str | bytes | Path
    """text (UTF-8), a picture, or a file to copy unless the one to write exists"""


class WatchCameras(Action, frozen=True):
    """Subscribe to exactly these pictures."""

    wanted: frozenset[tuple[str, str]]
    """side and eye of the visible pictures, for example `("sim", "left")`"""


class WatchMicrophones(Action, frozen=True):
    """Subscribe to the microphones of exactly these sides, which switches them on."""

    sides: frozenset[str]


class BeginRecording(Action, frozen=True):
    """Start `beatrix record`."""


class EndRecording(Action, frozen=True):
    """End the recording."""


class ViewRecording(Action, frozen=True):
    """Start `beatrix view FILE`."""

    file: Path


class Retry(Action, frozen=True):
    """Look for the router again now."""


class UseRouter(Action, frozen=True):
    """Check the router at this address, and use it."""

    address: str
    """as the user has typed it; for the link an endpoint"""


class UseAccount(Action, frozen=True):
    """Check the account file of a seat, store it for the user, and use its router and seat."""

    file: Path


class ChooseRobot(Action, frozen=True):
    """Show and drive the robots of this name."""

    name: str


class StartSimulation(Action, frozen=True):
    """Start a simulation on this computer, and a router if there is none, as children of the window."""


class LookForPorts(Action, frozen=True):
    """Show the sheet that connects, and list the serial ports of this computer."""


class ConnectHardware(Action, frozen=True):
    """Start the program of the hardware, and a router if there is none, as children of the window."""

    port: str
    """serial port, or `virtual:`"""


@dataclass(frozen=True)
class Outcome:
    """The result of an action, at one robot or at several."""

    row: int
    side: str
    """`sim` or `hw`; empty: the outcome is that of several robots, or no robot was reached"""
    accepted: bool
    """true: a motion was accepted, or a command carried out; false: refused, or the motion did not reach its goal"""
    done: bool
    """whether this is the last outcome of this robot and row"""
    reason: Reason = Reason.OK
    message: str = ""
    """the SDK's message or error text, in English"""
    detail: Detail | None = None
    """a refusal as data, for the sentence in another language"""
    key: str = ""
    """a text of the faces that says why, for a failure of the window itself; empty: reason and detail say it"""
    slots: Mapping[str, str | float] = field(default_factory=dict)
    duration_s: float = 0.0
    """expected duration of an accepted motion, or measured duration of one that has ended (s)"""
    robots: int = 0
    """number of robots that a request to several robots was sent to"""
    failed: tuple[str, ...] = ()
    """robots that refused the request or did not answer, for example `bea1 (hw)`; `reason` is that of the first"""
    rounds: int = 0
    """how often the poses of a play that repeats were played to their end"""
    block: str = ""
    """id of the block at which a program of blocks has ended early"""
