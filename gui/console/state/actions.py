"""Actions, which `link.Link` carries out, and the `Outcome`s that it reports for each action with a row.

Each action is an intent, too: buttons report actions for which nothing is left to decide, or only the row.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
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


Shares = tuple[tuple[str, float], ...]
"""Arms, `all` or axes of the head, each with its speed divided by the chosen one, -1 to 1."""


class Hold(Action, frozen=True):
    """Move some robots while a button or stick is held; repeated as a heartbeat, without which they stop within 0.5 s."""

    row: int
    """also the number of the press"""
    shares: Shares
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


class SendNow(Action, frozen=True):
    """Send the waiting motion of both robots to the hardware now."""


class Abort(Action, frozen=True):
    """End the motion of both robots; the hardware stays unmoved, or stops if it moves already."""


POSES = "poses"
"""The name of a play of poses."""


class Play(Action, frozen=True):
    """Play a gesture, or poses that begin at their times."""

    row: int
    sides: tuple[str, ...]
    poses: tuple[ArmPose, ...] = ()
    again: tuple[ArmPose, ...] = ()
    """played after `poses`, over and over until a newer request or STOP; empty: the play ends"""
    lead_s: float = 0.0
    gesture: str = ""
    """name of a shipped choreography, or of a gesture of the user; empty: the poses are played"""
    notes: tuple[int, ...] = ()
    """tone of each pose, as of `SavedPose`"""

    @property
    def title(self) -> str:
        """The name of the gesture, or POSES."""
        return self.gesture or POSES


class RunBlocks(Action, frozen=True):
    """Run a program of blocks."""

    row: int
    sides: tuple[str, ...]
    program: str
    """as of the intent"""
    lead_s: float = 0.0


class EndBlocks(Action, frozen=True):
    """End the program of blocks."""


EXAMPLES: Final = Path(str(resources.files("beatrix_zenoh"))) / "examples"
FOLLOW: Final = EXAMPLES / "follow_the_face.py"
TURN: Final = EXAMPLES / "turn_to_the_sound.py"
"""The folder of the shipped programs, and those with a button."""


class RunProgram(Action, frozen=True):
    """Run a Python program as a child process of the window."""

    row: int
    file: Path
    sides: tuple[str, ...] = ()
    """its arguments; of a shipped program, the first one's left eye sees, or its ears hear"""


class EndProgram(Action, frozen=True):
    """End the program that runs."""


class OpenProgram(Action, frozen=True):
    """Show a program in the code panel."""

    file: Path | None = None
    """None: the program of the presses"""


class WriteProgram(Action, frozen=True):
    """Write what the user has typed."""

    text: str
    file: Path | None = None
    """None: the file of the present program; without an ending: the folder of a new one"""


class MovePerson(Action, frozen=True):
    """Place the eyes of the simulated person (m from the neck's centre), which ends the person's walk."""

    x: float
    y: float
    z: float


class LetSpeak(Action, frozen=True):
    """Let the simulated person speak, or be silent."""

    on: bool


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
    content: str | bytes
    """text (UTF-8), or a picture"""


class KeepGesture(Action, frozen=True):
    """Write a gesture of the user, or delete one; the outcome names no robot."""

    row: int
    name: str
    """empty: none is written"""
    text: str
    instead: str = ""
    """the gesture that goes to the deleted ones, besides that of the same name; empty: none"""


class ShareGesture(Action, frozen=True):
    """Give a gesture of the user to the class."""

    name: str
    row: int = NEW


class FetchGestures(Action, frozen=True):
    """Write the gestures of the class to the folder of the user; of pupils those that the teacher has shared."""

    row: int = NEW


class UseSounds(Action, frozen=True):
    """Play music and tones with sequences, or be silent."""

    on: bool
    music: str = ""
    """path; empty: none"""


class Watch(Action, frozen=True):
    """Receive exactly this, besides the states of the shown robots."""

    class_page: bool = False
    """the states of all robots, and the reports of lessons"""
    cameras: frozenset[tuple[str, str]] = frozenset()
    """side and eye of the visible pictures, for example `("sim", "left")`"""
    microphones: frozenset[str] = frozenset()
    """sides, whose microphones are on meanwhile"""
    person: bool = False
    """where the simulated person is"""


class BeginRecording(Action, frozen=True):
    """Start `beatrix record`."""


class EndRecording(Action, frozen=True):
    """End the recording."""


class ViewRecording(Action, frozen=True):
    """Start `beatrix view FILE`."""

    file: Path


class TakePicture(Action, frozen=True):
    """Take a photo of robots, or begin a film."""

    film: bool
    sides: tuple[str, ...]
    titles: tuple[str, ...]
    """over each robot"""
    caption: str


class EndFilm(Action, frozen=True):
    """End the film."""


class OpenPicture(Action, frozen=True):
    """Open a photo or film with the user's program for it."""

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
