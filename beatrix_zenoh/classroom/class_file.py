"""The class file, which the teacher writes."""

from __future__ import annotations

import ipaddress
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files, names
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.account import Role
from beatrix_zenoh.errors import WrongUsage, quoted

Auth = Literal["password", "certificate"]
LONGEST = 64 * 1024
"""Largest size of a class file (bytes)."""
SEATS_MAX = 99
EXAMPLE = 'name = "8b", addresses = ["192.168.1.20"], seats = 30, robots = ["bea1"]'


class _Router(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    port: int = 7447
    standby: str = ""
    pictures_hz: float = 5.0


class _ClassFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    name: str
    addresses: list[str]
    seats: int | list[str]
    robots: list[str] = []
    teacher: str = ""
    auth: Auth = "password"
    router: _Router = _Router()


@dataclass(frozen=True)
class Classroom:
    """A class; its names are valid in keys and unique."""

    name: str
    addresses: tuple[str, ...]
    """addresses at which seats and robots reach the router"""
    seats: tuple[str, ...]
    robots: tuple[str, ...]
    certificates: bool
    """whether accounts have certificates instead of passwords"""
    teacher: str = ""
    """the teacher's name on the cards"""
    port: int = 7447
    standby: str = ""
    """address of the second router; empty: none"""
    pictures_hz: float = 5.0

    @property
    def protocol(self) -> str:
        """Protocol of the endpoints."""
        return "tls" if self.certificates else "tcp"

    @property
    def listen(self) -> str:
        """Endpoints of the router."""
        return ",".join(f"{self.protocol}/{address}:{self.port}" for address in self.addresses)

    @property
    def standby_listen(self) -> str:
        """Endpoint of the second router; empty: none."""
        return f"{self.protocol}/{self.standby}:{self.port}" if self.standby else ""

    @property
    def connect(self) -> str:
        """Endpoints for seats and robots, in the order in which they are tried."""
        return ",".join(filter(None, (self.listen, self.standby_listen)))

    @property
    def link(self) -> str:
        """Endpoint at which the router accepts the second router; empty: there is no second router."""
        return f"tls/{self.addresses[0]}:{self.port + 1}" if self.standby else ""

    @property
    def accounts(self) -> dict[str, Role]:
        """Role of each account by its name."""
        found: dict[str, Role] = {names.TEACHER: "teacher"}
        found.update(dict.fromkeys(self.seats, "student"))
        found.update(dict.fromkeys(self.robots, "robot"))
        return found


def _converted(path: Path, table: dict[str, object]) -> _ClassFile:
    """Check the fields of a table and convert it; raises WrongUsage."""
    for given, kind, section in ((table, _ClassFile, ""), (table.get("router"), _Router, " of [router]")):
        if isinstance(given, dict) and (unknown := files.unknown_fields(given, kind)):
            known = ", ".join(kind.__struct_fields__)
            hint = ". Write it below a line [router]" if unknown[0] in _Router.__struct_fields__ else ""
            raise wrong(path, f"{quoted(unknown[0])} is not a field{section}. Fields: {known}{hint}")
    if (auth := table.get("auth", "password")) not in get_args(Auth):
        raise wrong(path, f'auth is {quoted(str(auth))}: "password" or "certificate" is allowed')
    try:
        return msgspec.convert(table, _ClassFile)
    except msgspec.ValidationError as error:
        raise wrong(path, f"a field is wrong: {error}. Write, for example, {EXAMPLE}") from error


def read(path: Path) -> Classroom:
    """Read a class file and check it.

    Raises:
        WrongUsage: BAD_VALUE, with the field and its allowed values.
    """
    try:
        file = _converted(path, files.toml(path, LONGEST))
    except OSError as error:
        raise wrong(path, f"cannot be read: {error}. Write, for example, {EXAMPLE}") from error
    count = file.seats if isinstance(file.seats, int) else len(file.seats)
    if not 1 <= count <= SEATS_MAX:
        raise wrong(path, f"seats is {count}: 1 to {SEATS_MAX} are allowed")
    if not file.addresses:
        raise wrong(path, 'addresses is empty: give the address of the router, for example ["192.168.1.20"]')
    if wrong_address := next(filter(_impossible, [*file.addresses, file.router.standby]), None):
        raise wrong(path, f"{wrong_address} is not an address: give an IP address or the name of a computer")
    if file.router.standby in file.addresses:
        raise wrong(
            path,
            f"standby {file.router.standby} is also in addresses: the second router runs on a computer of its own",
        )
    if not 0.1 <= file.router.pictures_hz <= 60:
        raise wrong(path, f"pictures_hz is {file.router.pictures_hz}: 0.1 to 60 are allowed")
    seats = [f"seat{n:02d}" for n in range(1, count + 1)] if isinstance(file.seats, int) else file.seats
    _check_names(path, file, seats)
    made = Classroom(
        name=file.name,
        addresses=tuple(map(_host, file.addresses)),
        seats=tuple(seats),
        robots=tuple(file.robots),
        certificates=file.auth == "certificate",
        teacher=file.teacher,
        port=file.router.port,
        standby=_host(file.router.standby),
        pictures_hz=file.router.pictures_hz,
    )
    for endpoint in zbus.endpoints(f"{made.connect},{made.link or made.listen}"):
        zbus.parse_endpoint(endpoint)
        # Zenoh 1.10 compares an IPv6 address with its brackets, but certificates contain it without them.
        if endpoint.startswith("tls/["):
            raise wrong(path, f"{endpoint} cannot have a certificate: give an IPv4 address or a name instead")
    return made


def _check_names(path: Path, file: _ClassFile, seats: list[str]) -> None:
    names.check_name(file.name, "class")
    for seat in seats:
        names.check_seat(seat)
    for robot in file.robots:
        names.check_name(robot)
    used = Counter([names.TEACHER, *seats, *file.robots])
    if twice := [name for name, times in used.items() if times > 1]:
        raise wrong(
            path,
            f"{', '.join(twice)} is used twice: give each seat and robot a name of its own, not `{names.TEACHER}`",
        )


def wrong(path: Path, text: str) -> WrongUsage:
    """Return the error for an invalid class file."""
    return WrongUsage(Reason.BAD_VALUE, f"{path}: {text}.")


def _impossible(address: str) -> bool:
    """Return whether a text has the form of an IP address but is not one, such as 192.168.300.20."""
    if not re.fullmatch(r"[0-9.]+|.*:.*", address):
        return False
    try:
        ipaddress.ip_address(address.strip("[]"))
    except ValueError:
        return True
    return False


def _host(address: str) -> str:
    """Return an address in the form for endpoints: an IPv6 address gets brackets."""
    return f"[{address}]" if ":" in address and not address.startswith("[") else address
