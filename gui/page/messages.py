"""Messages between the control page and its server, as JSON."""

from __future__ import annotations

from typing import Annotated, Final, Literal

import msgspec
from msgspec import Meta

ROTATIONS: Final = ("yaw", "pitch", "roll")
SLOWEST_DEG_S, FASTEST_DEG_S = 2.0, 40.0

Name = Annotated[str, Meta(min_length=1, max_length=32)]
Press = Annotated[int, Meta(ge=1, le=2**53)]
"""Number of a press of a button; a page counts its presses."""
Speed = Annotated[float, Meta(ge=SLOWEST_DEG_S, le=FASTEST_DEG_S)]
"""Speed of the fastest arm, deg/s."""


class Message(msgspec.Struct, frozen=True, tag_field="do", forbid_unknown_fields=True):
    """Base class of the messages of a page; the field `do` names the class."""


class Watch(Message, frozen=True, tag="watch"):
    """Show another robot."""

    robot: Name
    side: Literal["sim", "hw"]


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
    """The page has received a state."""


class Hold(Message, frozen=True, tag="hold"):
    """A button is held: the heartbeat of a jog."""

    press: Press
    part: Literal["yaw", "pitch", "roll", "short", "middle", "long"]
    sign: Literal[-1, 1]
    speed: Speed


class Release(Message, frozen=True, tag="release"):
    """The button of this press is no longer held."""

    press: Press


class Home(Message, frozen=True, tag="home"):
    """Turn all arms to 0 degrees."""

    speed: Speed


class Do(Message, frozen=True, tag="command"):
    """Send a command."""

    command: Literal["ready", "disable", "reset"]


class Stop(Message, frozen=True, tag="stop"):
    """STOP for simulation and hardware of a name."""

    robot: Name
    stop: Name
    """a number that no other STOP of this browser has"""


Request = Watch | Drive | Leave | Beat | Hidden | Seen | Hold | Release | Home | Do | Stop
_DECODER: Final = msgspec.json.Decoder(Request)


def read(text: str | bytes) -> Request:
    """Return the decoded message of a page; raises msgspec.DecodeError."""
    request: Request = _DECODER.decode(text)
    return request


class Outcome(msgspec.Struct, frozen=True, tag_field="kind", tag="outcome"):
    """The outcome of a request, for the page, which shows it beside the control."""

    control: str
    """`drive`, `stop`, `robot`, `home`, the part of a jog, or a command"""
    ok: bool
    text: str = ""
    """a sentence; empty: done as requested"""


def refused(control: str, text: str) -> Outcome:
    """Return the outcome of a request that was not carried out."""
    return Outcome(control, ok=False, text=text)
