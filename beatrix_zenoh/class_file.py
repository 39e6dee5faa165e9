"""The class file, which the teacher writes."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files
from beatrix_zenoh.account import Role
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import WrongUsage, wrong_usage

LONGEST = 64 * 1024
"""Largest size of a class file (bytes)."""
SEATS_MAX = 99
DISPLAY_MAX = 48
"""Largest number of characters of a pupil's name."""
FORM = (
    'Write, for example, name = "8b", addresses = ["192.168.1.20"], seats = 30, robots = ["bea1"], and below them, if they '
    'are needed, the sections [router] with port and pictures_hz, and [seats] with names of pupils: zoe = "Zoë Müller"'
)
WORDS = {chunk for row in keys.KEYS.values() for chunk in row.key.split("/")[1:] if chunk.isalpha()}
"""Words of the keys, such as `stop` and `pose`; as a name they would make the rule for STOP include other keys."""


ADDRESS = r"^[A-Za-z0-9.-]+$"
"""Form of an IPv4 address or a name. Zenoh 1.10 compares an IPv6 address with its brackets, but certificates have none."""


class _Router(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    port: Annotated[int, Meta(ge=0, le=65534)] = 7447
    """port of the router of robots and teacher"""
    pictures_hz: Annotated[float, Meta(ge=0.1, le=60)] = 5.0
    """largest rate of pictures for each seat"""
    page: Annotated[int, Meta(ge=1, le=65535)] = 8088
    """port of the control page for tablets"""


class Classroom(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A class; its names are valid in keys and unique."""

    name: str
    addresses: Annotated[tuple[Annotated[str, Meta(pattern=ADDRESS)], ...], Meta(min_length=1)]
    """addresses at which seats and robots reach the router"""
    given: (
        Annotated[int, Meta(ge=1, le=SEATS_MAX)]
        | Annotated[tuple[str, ...], Meta(min_length=1, max_length=SEATS_MAX)]
        | Annotated[dict[str, str], Meta(min_length=1, max_length=SEATS_MAX)]
    ) = msgspec.field(name="seats")
    """the number of the seats, their names, or the names of the pupils by seat"""
    robots: tuple[str, ...] = ()
    teacher: str = ""
    """the teacher's name on the cards"""
    router: _Router = _Router()

    @property
    def seats(self) -> tuple[str, ...]:
        """The names of the seats."""
        if isinstance(self.given, int):
            return tuple(f"seat{number:02d}" for number in range(1, self.given + 1))
        return tuple(self.given)

    @property
    def display_names(self) -> dict[str, str]:
        """Names of the pupils by seat, in any alphabet; empty: those of the seats."""
        return self.given if isinstance(self.given, dict) else {}

    @property
    def listen(self) -> str:
        """Endpoints of the router of robots and teacher, in the order in which they try them."""
        return self._endpoints(self.router.port)

    @property
    def listen_seats(self) -> str:
        """Endpoints of the router of the seats: the next port."""
        return self._endpoints(self.router.port + 1)

    def _endpoints(self, port: int) -> str:
        return ",".join(f"tls/{address}:{port}" for address in self.addresses)

    @property
    def page(self) -> str:
        """Address of the control page."""
        return f"http://{self.addresses[0]}:{self.router.page}/"

    @property
    def accounts(self) -> dict[str, Role]:
        """Role of each account by its name."""
        found: dict[str, Role] = {names.TEACHER: "teacher"}
        found.update(dict.fromkeys(self.seats, "student"))
        found.update(dict.fromkeys(self.robots, "robot"))
        return found


def read(path: Path) -> Classroom:
    """Read a class file and check it.

    Raises:
        WrongUsage: BAD_VALUE, with the field and its allowed values.
    """
    try:
        made = msgspec.convert(files.toml(path, LONGEST), Classroom)
    except (OSError, msgspec.ValidationError) as error:
        raise wrong(path, f"cannot be read: {error}. {FORM}") from error
    _check_names(path, made)
    for endpoint in zbus.endpoints(made.listen_seats):
        zbus.parse_endpoint(endpoint)
    return made


def folder(path: Path, classroom: Classroom) -> Path:
    """Return the folder of the files of a class: beside its class file, under the name of the class."""
    return path.parent / classroom.name


def _check_names(path: Path, file: Classroom) -> None:
    try:
        names.check_name(file.name, "class")
        for seat in file.seats:
            names.check_seat(seat)
        for robot in file.robots:
            names.check_name(robot)
    except WrongUsage as error:
        raise wrong(path, f"{error.message} {FORM}") from error
    for seat, name in file.display_names.items():
        if not (name.isprintable() and len(name) <= DISPLAY_MAX):
            raise wrong(path, f"the name of {seat} must be of at most {DISPLAY_MAX} characters, on one line")
    for name, times in Counter([names.TEACHER, *WORDS, *file.seats, *file.robots]).items():
        if times > 1:
            raise wrong(
                path,
                f"{name} is used twice, or by BEATRIX itself: give each seat and robot a name of its own. The teacher has an "
                "account in every class",
            )


def wrong(path: Path, text: str) -> WrongUsage:
    """Return the error for an invalid class file."""
    return wrong_usage(f"{path}: {text}.")
