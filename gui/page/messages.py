"""Messages of the control page to its server, as JSON: those of the page itself, and intents of the console."""

from __future__ import annotations

from typing import Annotated, Final, Literal

import msgspec
from msgspec import Meta

from gui.console.state import intents
from gui.console.state.saved import Saved

ROTATIONS: Final = ("yaw", "pitch", "roll")

Name = Annotated[str, Meta(min_length=1, max_length=32)]
Press = Annotated[int, Meta(ge=1, le=2**53)]
"""Number of a press of a button; a page counts its presses."""


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


class Seen(Message, frozen=True, tag="seen"):
    """The page has received a view."""


class Hold(Message, frozen=True, tag="hold"):
    """A button is held: the heartbeat of a jog."""

    press: Press
    part: Literal["yaw", "pitch", "roll", "short", "middle", "long"]
    sign: Literal[-1, 1]


class Release(Message, frozen=True, tag="release"):
    """The button of this press is no longer held."""

    press: Press


class ShowClass(Message, frozen=True, tag="class"):
    """Show or hide the table of all robots."""

    on: bool


class StopRobot(Message, frozen=True, tag="stop"):
    """STOP for simulation and hardware of a name."""

    robot: Name
    stop: Name
    """a number that no other STOP of this browser has"""


OWN: Final = (
    intents.SetLanguage
    | intents.SetSpeed
    | intents.SetLead
    | intents.SetDestination
    | intents.SetCameras
    | intents.AimHead
    | intents.DismissRefusal
    | intents.DismissNotice
    | intents.DeletePose
    | intents.SavePose
    | intents.ChooseRobot
    | intents.EmergencyStop
)
"""Intents of every page: they change only this page, or stop robots."""
DRIVING: Final = (
    intents.SendHead
    | intents.RunCommand
    | intents.MakeReady
    | intents.AskLease
    | intents.SendNow
    | intents.Change
    | intents.Abort
    | intents.TakeAlternative
    | intents.Undo
    | intents.Repeat
    | intents.GoToPose
    | intents.PlayPoses
)
"""Intents of a page that drives. No page may use other ones, for example those that start programs or name files."""
Request = (
    Open | Drive | Leave | Beat | Hidden | Seen | Hold | Release | ShowClass | StopRobot | intents.Intent
)
_DECODER: Final = msgspec.json.Decoder(
    Open | Drive | Leave | Beat | Hidden | Seen | Hold | Release | ShowClass | StopRobot | OWN | DRIVING
)


def read(text: str | bytes) -> Request:
    """Return the decoded message of a page; raises msgspec.DecodeError."""
    request: Request = _DECODER.decode(text)
    return request
