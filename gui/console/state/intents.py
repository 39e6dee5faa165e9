"""Intents of the user, as widgets report them; angles in degrees, speeds in deg/s, times in s."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from beatrix_zenoh.client import Place
from beatrix_zenoh.contract._generated.messages import Command, LeaseAction

ALL_ARMS = "all"


class Tab(StrEnum):
    """A tab of the middle column."""

    HEADS = "heads"
    EYES = "eyes"
    PLOTS = "plots"


class Page(StrEnum):
    """A page of the window."""

    ROBOT = "robot"
    """simulation and hardware of one name"""
    CLASS = "class"
    """all robots and seats at the router; only in the teacher's window"""


class Theme(StrEnum):
    """Colours and sizes."""

    DARK = "dark"
    LIGHT = "light"
    PROJECTOR = "projector"


@dataclass(frozen=True)
class Intent:
    """Base class of all intents."""


@dataclass(frozen=True)
class Stop(Intent):
    """Stop the robots of the shown page at once, regardless of the checked boxes."""


@dataclass(frozen=True)
class EmergencyStop(Intent):
    """Switch the motors of the robots of the shown page off at once; their heads fall."""


@dataclass(frozen=True)
class Jog(Intent):
    """+ or - of an arm: in relative mode turn it by the increment, in absolute mode send it to + or - the increment."""

    arm: str
    """`short`, `middle`, `long` or `all`"""
    sign: int
    """+1 or -1"""


@dataclass(frozen=True)
class AimHead(Intent):
    """Move the target of the head pad; nothing is sent."""

    yaw: float
    pitch: float
    roll: float


@dataclass(frozen=True)
class SendHead(Intent):
    """Send the target of the head pad."""


@dataclass(frozen=True)
class SetRelative(Intent):
    """Choose relative or absolute mode."""

    relative: bool


@dataclass(frozen=True)
class SetIncrement(Intent):
    """Choose how far + and - turn an arm (deg)."""

    degrees: float


@dataclass(frozen=True)
class SetSpeed(Intent):
    """Choose the speed of the fastest arm (deg/s)."""

    degrees_per_s: float


@dataclass(frozen=True)
class SetDestination(Intent):
    """Check or clear the box of the hardware or of the simulation."""

    side: str
    checked: bool


@dataclass(frozen=True)
class SetCameras(Intent):
    """Check or clear the box of the eye cameras."""

    on: bool


@dataclass(frozen=True)
class ShowTab(Intent):
    """Show another tab in the middle column."""

    name: Tab


@dataclass(frozen=True)
class SetLead(Intent):
    """Choose by how much the simulation leads the hardware (s); 0: they move at the same time."""

    seconds: float


@dataclass(frozen=True)
class RunCommand(Intent):
    """Send a command to the checked robots, or to one robot as its next step."""

    command: Command
    value: bool = True
    """for ENABLE: on or off"""
    side: str = ""
    """`sim` or `hw`; empty: the checked robots"""


@dataclass(frozen=True)
class MakeReady(Intent):
    """Enable and calibrate one robot, unless that is done already."""

    side: str


@dataclass(frozen=True)
class AskLease(Intent):
    """Take a robot, wait for it, or give it back."""

    action: LeaseAction
    """TAKE, WAIT or GIVE_BACK"""
    side: str


@dataclass(frozen=True)
class DismissNotice(Intent):
    """Hide the sentence about a lease that this seat gained or lost."""


@dataclass(frozen=True)
class TogglePage(Intent):
    """Switch between the page of the class and the robot; only in the teacher's window."""


@dataclass(frozen=True)
class GovernClass(Intent):
    """Freeze, unfreeze, take or give back robots of the class, as the teacher."""

    action: LeaseAction
    place: Place | None = None
    """name and side of one robot; None: all robots online"""


@dataclass(frozen=True)
class MuteSeat(Intent):
    """Let a seat only watch all robots of the class, or end that, as the teacher."""

    seat: str
    on: bool


@dataclass(frozen=True)
class LimitClass(Intent):
    """Limit the speed of all robots of the class, as the teacher."""

    text: str
    """deg/s as the user has typed it; empty: no limit"""


@dataclass(frozen=True)
class SendNow(Intent):
    """Send the waiting motion of both robots to the hardware now."""


@dataclass(frozen=True)
class Change(Intent):
    """End the motion before the hardware moves, and restore its target on the pad."""


@dataclass(frozen=True)
class Abort(Intent):
    """End the motion of both robots; the hardware stays unmoved, or stops if it moves already."""


@dataclass(frozen=True)
class TakeAlternative(Intent):
    """Send the alternative or next step of the shown refusal."""


@dataclass(frozen=True)
class DismissRefusal(Intent):
    """Hide the shown refusal."""


@dataclass(frozen=True)
class Undo(Intent):
    """Turn the arms back to their angles before the last motion."""


@dataclass(frozen=True)
class Repeat(Intent):
    """Send a row of the history again."""

    row: int
    """number of the row"""


@dataclass(frozen=True)
class SavePose(Intent):
    """Save the present arm angles under a name."""

    name: str


@dataclass(frozen=True)
class DeletePose(Intent):
    """Delete a saved pose."""

    name: str


@dataclass(frozen=True)
class GoToPose(Intent):
    """Turn the arms to a saved pose."""

    name: str


@dataclass(frozen=True)
class PlayPoses(Intent):
    """Play saved poses one after the other, in the order of their list."""


@dataclass(frozen=True)
class PlayFile(Intent):
    """Play a choreography or motion file."""

    file: Path


@dataclass(frozen=True)
class SaveChoreography(Intent):
    """Write the saved poses as a choreography."""

    file: Path


@dataclass(frozen=True)
class ToggleRecording(Intent):
    """Begin or end a recording."""


@dataclass(frozen=True)
class OpenRecording(Intent):
    """Open the last recording in the viewer."""


@dataclass(frozen=True)
class ChooseRobot(Intent):
    """Show and drive the robots of this name."""

    name: str


@dataclass(frozen=True)
class StartSimulation(Intent):
    """Start a simulation on this computer, and a router if there is none."""


@dataclass(frozen=True)
class Retry(Intent):
    """Look for the router again now."""


@dataclass(frozen=True)
class SetTheme(Intent):
    """Choose colours and sizes."""

    theme: Theme


@dataclass(frozen=True)
class SetLanguage(Intent):
    """Choose a language by its ISO 639-1 code."""

    code: str
