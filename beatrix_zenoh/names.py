"""Names of robots and seats: the words that stand in key expressions."""

from __future__ import annotations

import getpass
import re
import socket

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import WrongUsage, quoted

PATTERN = re.compile(r"[a-z0-9-]{1,32}")
TWINS = ("sim", "hw")
OLD_PROGRAMS, ARM_TOPICS = "legacy", "arm-topics"
"""Seats under which a node lets those drive who have no seat of their own."""


def check_name(text: str, what: str = "robot") -> str:
    """Return `text` if it may stand in a key.

    Raises:
        WrongUsage: BAD_VALUE, with the nearest name that would be accepted.
    """
    text = str(text)  # a program may count its robots
    if PATTERN.fullmatch(text):
        return text
    raise WrongUsage(
        Reason.BAD_VALUE,
        f"{quoted(text)} is no {what} name: 1 to 32 of a-z, 0-9 and - are allowed, for example {tidy(text)!r}.",
    )


def check_seat(text: str) -> str:
    """Return `text` if somebody may drive under it; raises as `check_name`."""
    if text in (OLD_PROGRAMS, ARM_TOPICS):
        raise WrongUsage(
            Reason.BAD_VALUE, f"{text!r} is the seat of programs that have none of their own: choose another."
        )
    return check_name(text, "seat")


def tidy(text: str) -> str:
    """The nearest allowed name."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:32].strip("-") or "beatrix"


def default_seat() -> str:
    """The seat of somebody who did not say: the user's name."""
    try:
        return tidy(getpass.getuser())
    except (OSError, KeyError, ImportError):  # no such user, as in some containers
        return "somebody"


def default_robot() -> str:
    """The name of a simulation that was not given one: user-host, so that no two are alike."""
    return tidy(f"{default_seat()}-{socket.gethostname().partition('.')[0]}")
