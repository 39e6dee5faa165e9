"""Names of robots and seats in key expressions."""

from __future__ import annotations

import getpass
import re
import socket
import unicodedata

from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import quoted, wrong_usage

LATIN = str.maketrans(
    {"ß": "ss", "æ": "ae", "œ": "oe", "ø": "o", "ł": "l", "đ": "d", "ð": "d", "þ": "th", "ı": "i"}
)
"""Small letters that Unicode does not decompose into a letter of a-z and an accent."""
PATTERN = keys.NAME
SIDES = ("sim", "hw")
SIDE_TITLES = {"sim": "simulation", "hw": "hardware"}
ARMS = ("short", "middle", "long")
"""Names of the arms in the order x, y, z."""
EYES = ("left", "right")
OUTSIDE = "outside"
"""The camera that sees the simulated head from outside; only simulations have it."""
VIEWS = (*EYES, OUTSIDE)
"""Names of all cameras."""
TEACHER = "teacher"
"""The seat that outranks all others."""
OLD_PROGRAMS, ARM_TOPICS = "legacy", "arm-topics"
"""Seats for programs of 2023 and for the per-arm topics, because both send no seat."""


def check_name(text: str, what: str = "robot") -> str:
    """Return `text` if it is a valid name.

    Raises:
        WrongUsage: BAD_VALUE; the message suggests a similar valid name.
    """
    text = str(text)  # programs may pass a number
    if PATTERN.fullmatch(text):
        return text
    raise wrong_usage(
        f"{quoted(text)} is not a {what} name: 1 to 32 of a-z, 0-9 and - are allowed, for example {tidy(text, f'{what}1')!r}.",
    )


def check_seat(text: str) -> str:
    """Return `text` if it is a valid seat of a client; raises WrongUsage (BAD_VALUE) for invalid or reserved names."""
    if text in (OLD_PROGRAMS, ARM_TOPICS):
        raise wrong_usage(f"The seat {text!r} is reserved for programs without a seat: choose another.")
    return check_name(text, "seat")


def view_title(eye: str) -> str:
    """Return the name of a camera in a sentence: `left eye`, `outside view`."""
    return f"{eye} view" if eye == OUTSIDE else f"{eye} eye"


def tidy(text: str, otherwise: str = "beatrix") -> str:
    """Return a valid name that is similar to `text`, without accents; `otherwise` if no character can be written so."""
    decomposed = unicodedata.normalize("NFKD", text.lower().translate(LATIN))
    plain = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    return re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:32].strip("-") or otherwise


def default_seat() -> str:
    """Return the default seat: the name of the user."""
    try:
        return tidy(getpass.getuser())
    except (OSError, KeyError, ImportError):  # the user has no name, as in some containers
        return "user"


def default_robot() -> str:
    """Return the default name of a robot: names of user and computer, so that it differs between computers."""
    return tidy(f"{default_seat()}-{socket.gethostname().partition('.')[0]}")
