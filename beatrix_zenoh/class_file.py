"""The class file, which the teacher writes."""

from __future__ import annotations

import ipaddress
import re
import tomllib
from collections import Counter
from pathlib import Path

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files
from beatrix_zenoh.account import Role
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage, quoted

LONGEST = 64 * 1024
"""Largest size of a class file (bytes)."""
SEATS_MAX = 99
DISPLAY_MAX = 48
"""Largest number of characters of a pupil's name."""
GONE = {
    "auth": "every class uses certificates and encryption. Delete the line and the folder of the class, run `beatrix "
    "classroom init`, and hand out all files again",
    "standby": "a class has one router. Delete the line, and run `beatrix classroom init`",
}
"""What to do about fields of earlier versions."""
EXAMPLE = 'name = "8b", addresses = ["192.168.1.20"], seats = 30, robots = ["bea1"]'

NAMED = 'The name of a seat, left of =, may contain only a-z, 0-9 and -: for example zoe = "Zoë Müller".'
"""What to do about invalid TOML, in which a pupil's name is often the key."""
WORDS = {chunk for row in keys.KEYS.values() for chunk in row.key.split("/")[1:] if chunk.isalpha()}
"""Words of the keys, such as `stop` and `pose`; as a name they would make the rule for STOP include other keys."""


class _Router(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    port: int = 7447
    pictures_hz: float = 5.0


class Classroom(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A class; its names are valid in keys and unique."""

    name: str
    addresses: tuple[str, ...]
    """addresses at which seats and robots reach the router"""
    given: int | tuple[str, ...] | dict[str, str] = msgspec.field(name="seats")
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
    def port(self) -> int:
        """Port of the router of robots and teacher."""
        return self.router.port

    @property
    def pictures_hz(self) -> float:
        """Largest rate of pictures for each seat."""
        return self.router.pictures_hz

    @property
    def listen(self) -> str:
        """Endpoints of the router of robots and teacher, in the order in which they try them."""
        return self._endpoints(self.port)

    @property
    def listen_seats(self) -> str:
        """Endpoints of the router of the seats: the next port."""
        return self._endpoints(self.port + 1)

    def _endpoints(self, port: int) -> str:
        return ",".join(f"tls/{address}:{port}" for address in self.addresses)

    @property
    def accounts(self) -> dict[str, Role]:
        """Role of each account by its name."""
        found: dict[str, Role] = {names.TEACHER: "teacher"}
        found.update(dict.fromkeys(self.seats, "student"))
        found.update(dict.fromkeys(self.robots, "robot"))
        return found


def _converted(path: Path, table: dict[str, object]) -> Classroom:
    """Check the fields of a table and convert it; raises WrongUsage."""
    router = table.get("router")
    for gone, text in GONE.items():
        if gone in table or (isinstance(router, dict) and gone in router):
            raise wrong(path, f"{gone} is not a field any more: {text}")
    for given, kind, section in ((table, Classroom, ""), (router, _Router, " of [router]")):
        if isinstance(given, dict) and (unknown := files.unknown_fields(given, kind)):
            known = ", ".join(kind.__struct_encode_fields__)
            hint = ". Write it below a line [router]" if unknown[0] in _Router.__struct_fields__ else ""
            raise wrong(path, f"{quoted(unknown[0])} is not a field{section}. Fields: {known}{hint}")
    try:
        return msgspec.convert(table, Classroom)
    except msgspec.ValidationError as error:
        hint = ". Other fields stand above the line [seats]" if isinstance(table.get("seats"), dict) else ""
        raise wrong(path, f"a field is wrong: {error}{hint}. Write, for example, {EXAMPLE}") from error


def read(path: Path) -> Classroom:
    """Read a class file and check it.

    Raises:
        WrongUsage: BAD_VALUE, with the field and its allowed values.
    """
    try:
        made = _converted(path, files.toml(path, LONGEST))
    except WrongUsage as error:
        if not isinstance(error.__cause__, tomllib.TOMLDecodeError):
            raise
        raise WrongUsage(error.reason, f"{error.message} {NAMED}") from error
    except OSError as error:
        raise wrong(path, f"cannot be read: {error}. Write, for example, {EXAMPLE}") from error
    count = made.given if isinstance(made.given, int) else len(made.given)
    if not 1 <= count <= SEATS_MAX:
        raise wrong(path, f"seats is {count}: 1 to {SEATS_MAX} are allowed")
    if not made.addresses:
        raise wrong(path, 'addresses is empty: give the address of the router, for example ["192.168.1.20"]')
    if wrong_address := next(filter(_impossible, made.addresses), None):
        # Zenoh 1.10 compares an IPv6 address with its brackets, but certificates contain it without them.
        raise wrong(path, f"{wrong_address} is not possible: give an IPv4 address or the name of a computer")
    if not 0.1 <= made.router.pictures_hz <= 60:
        raise wrong(path, f"pictures_hz is {made.router.pictures_hz}: 0.1 to 60 are allowed")
    _check_names(path, made)
    for endpoint in zbus.endpoints(made.listen_seats):
        zbus.parse_endpoint(endpoint)
    return made


def _check_names(path: Path, file: Classroom) -> None:
    names.check_name(file.name, "class")
    for seat in file.seats:
        _check_seat(path, seat)
    if long := [
        seat
        for seat, name in file.display_names.items()
        if not (name.isprintable() and len(name) <= DISPLAY_MAX)
    ]:
        raise wrong(path, f"the name of {long[0]} must be of at most {DISPLAY_MAX} characters, on one line")
    for robot in file.robots:
        names.check_name(robot)
    if names.TEACHER in (*file.seats, *file.robots):
        raise wrong(
            path,
            f"{names.TEACHER} is the account of the teacher, which every class has: leave it out of seats and robots",
        )
    if word := next((name for name in (*file.seats, *file.robots) if name in WORDS), None):
        raise wrong(
            path, f"{word} is a word of the keys, so the router could confuse the two: choose another name"
        )
    used = Counter([*file.seats, *file.robots])
    if twice := [name for name, times in used.items() if times > 1]:
        raise wrong(
            path,
            f"{', '.join(twice)} is used twice: give each seat and robot a name of its own",
        )


def _check_seat(path: Path, seat: str) -> None:
    try:
        names.check_seat(seat)
    except WrongUsage as error:
        name = names.tidy(seat, "seat01")
        raise wrong(
            path,
            f"{error.message} To show a name in any alphabet on cards and to the teacher, write the seats as a table at the "
            f'end of the file: a line [seats], and below it {name} = "{seat}"',
        ) from error


def wrong(path: Path, text: str) -> WrongUsage:
    """Return the error for an invalid class file."""
    return WrongUsage(Reason.BAD_VALUE, f"{path}: {text}.")


def _impossible(address: str) -> bool:
    """Return whether a text is an IPv6 address, or has the form of an IPv4 address but is none, as 192.168.300.20."""
    if not re.fullmatch(r"[0-9.]+|.*:.*", address):
        return False
    try:
        ipaddress.IPv4Address(address)
    except ValueError:
        return True
    return False
