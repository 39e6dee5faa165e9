"""Messages of the control page to its server, as JSON: those of the page itself, and intents of the console."""

from __future__ import annotations

from typing import Annotated, Final

import msgspec
from msgspec import Meta

from beatrix_zenoh.client import own_gestures
from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.contract._generated.messages import Command, LeaseAction
from gui.console.state import actions, intents, missions
from gui.console.state.arms import HoldArm, ReleaseArm, Steer
from gui.console.state.gestures import RunExample
from gui.console.state.intents import SetDuration
from gui.console.state.own_gestures import EMOJI, DeleteGesture
from gui.console.state.saved import Saved

Name = Annotated[str, Meta(min_length=1, max_length=32)]


class Message(msgspec.Struct, frozen=True, tag_field="do", forbid_unknown_fields=True):
    """Base class of the messages of the page itself; the field `do` names the class."""


class Open(Message, frozen=True, tag="open"):
    """The choices that this browser has kept."""

    saved: Saved


class Drive(Message, frozen=True, tag="drive"):
    """Take the robot, or wait for it."""

    name: Name


class Leave(Message, frozen=True, tag="leave"):
    """Give the robot back, or wait no longer."""


class Beat(Message, frozen=True, tag="beat"):
    """The heartbeat of a page that drives."""


class Hidden(Message, frozen=True, tag="hidden"):
    """The page is no longer visible."""


class ViewReceived(Message, frozen=True, tag="seen"):
    """The page has received a view."""


class ShowClass(Message, frozen=True, tag="class"):
    """Show or hide the table of all robots."""

    on: bool


class StopRobot(Message, frozen=True, tag="stop"):
    """STOP for simulation and hardware of a name."""

    robot: Name
    stop: Name
    """a number that no other STOP of this browser has"""


class SaveProgram(Message, frozen=True, tag="save_program"):
    """Keep a program of blocks: the JSON of the editor."""

    name: str
    program: str
    ran: bool = False
    """whether it begins to run, so that it is also kept as a version"""
    opens: bool = False
    """whether the page shows it, because it is another one than before"""


class OpenProgram(Message, frozen=True, tag="open_program"):
    """Show a program; no name: only list them anew. Only a teacher names a seat."""

    name: str
    seat: str = ""


class CheckProgram(Message, frozen=True, tag="check_program"):
    """Run a program of blocks, and judge the run with the check of a lesson."""

    lesson: Name
    program: str


class AskHint(Message, frozen=True, tag="hint"):
    """Give the next hint of a lesson."""

    lesson: Name


OWN: Final = (
    intents.Choose
    | intents.AimHead
    | intents.GrabHead
    | intents.DismissRefusal
    | intents.DismissNotice
    | intents.DeletePose
    | intents.AddPose
    | intents.MovePose
    | intents.UndoSequence
    | SetDuration
    | actions.ChooseRobot
    | intents.EmergencyStop
    | intents.LimitClass
    | actions.Govern
    | ReleaseArm
    | actions.EndBlocks
    | actions.EndProgram
    | missions.ShowHint
    | missions.SkipTask
    | missions.CloseGuide
    | missions.ResumeGuide
)
"""Intents of every page: they change only this page, or stop robots."""
DRIVING: Final = (
    HoldArm
    | Steer
    | intents.SendHead
    | intents.LiveHead
    | intents.ReleaseHead
    | intents.RunCommand
    | actions.MakeReady
    | actions.AskLease
    | actions.SendNow
    | intents.Change
    | actions.Abort
    | intents.TakeAlternative
    | intents.Undo
    | intents.Repeat
    | intents.PlaySequence
    | intents.RunBlocks
    | actions.Play
    | RunExample
    | intents.SaveGesture
    | DeleteGesture
)
"""Intents of a page that drives. No page may use other ones, for example those that start or name programs of its own."""
CHOICES: Final = ("language", "speed", "lead_s", "sim", "hw", "cameras", "live", "send_on_release")
"""Choices that a page may change."""
LEASES: Final = (LeaseAction.TAKE, LeaseAction.WAIT, LeaseAction.GIVE_BACK)
COMMANDS: Final = (Command.ENABLE, Command.CALIBRATE, Command.HOME, Command.RESET)
OwnMessage = (
    Open
    | Drive
    | Leave
    | Beat
    | Hidden
    | ViewReceived
    | ShowClass
    | StopRobot
    | SaveProgram
    | OpenProgram
    | CheckProgram
    | AskHint
)
Request = OwnMessage | intents.Intent
_DECODER: Final = msgspec.json.Decoder(OwnMessage | OWN | DRIVING)


def read(text: str | bytes) -> Request:
    """Return the decoded message of a page; raises msgspec.DecodeError for one that no page sends."""
    request: Request = _DECODER.decode(text)
    if not _possible(request):
        raise msgspec.ValidationError(f"no page sends {request}")
    return request


def _possible(request: Request) -> bool:
    """Return whether a page has a button for this command, lease or gesture, or a field for this choice."""
    match request:
        case actions.AskLease(action=action):
            return action in LEASES
        case actions.Play(gesture=gesture):  # no file, and no poses: those are of the sequence
            known = gesture in GESTURES or own_gestures.possible(gesture)
            return known and request == actions.Play(actions.NEW, (), gesture=gesture)
        case intents.SaveGesture(emoji=emoji):
            return emoji in EMOJI
        case intents.RunCommand(command=command):
            return command in COMMANDS
        case intents.Choose(name=name):
            return name in CHOICES
    return True
