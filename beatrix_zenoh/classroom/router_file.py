"""The file of the routers of a class: all data that they need, and the grants of the accounts.

A class has two routers: robots and teacher connect to one, the seats to the other, which connects to the first. So what
a seat sends or declares ends or delays at most the router of the seats.
"""

from __future__ import annotations

import datetime as dt
from collections.abc import Collection
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Literal

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus.credentials import Identity
from beatrix_zenoh.bus.router import EVERYTHING, ROOT, Grant, RouterAccess, below
from beatrix_zenoh.class_file import folder, read
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import wrong_usage
from beatrix_zenoh.output import typed

ROUTER = "@router"
"""Common name in the certificate of both routers; no account can have it."""
CHECK_KEY = keys.seats_router("robots")
"""Key on which the router of robots and teacher answers itself."""
LONGEST = 256 * 1024
"""Largest size of a router file (bytes)."""


class Part(StrEnum):
    """The two routers of a class."""

    ROBOTS = "robots"
    SEATS = "seats"

    @property
    def called(self) -> str:
        """What messages to the teacher call this router."""
        return "router of robots and teacher" if self is Part.ROBOTS else "router of the seats"


class RouterFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The fields of a router file."""

    class_name: str = msgspec.field(name="class")
    role: Literal["router"]
    listen: str
    listen_seats: str
    seats: tuple[str, ...]
    robots: tuple[str, ...]
    pictures_hz: float
    authority: str
    certificate: str
    key: str
    accounts: dict[str, str]
    """common name of the newest certificate of each account"""
    certificates: dict[str, str]
    """newest certificate (PEM) of each account"""
    expires: dt.date
    """last day of the first certificate that expires"""

    def __repr__(self) -> str:
        """Return role and class without the secrets."""
        return f"<router of class {self.class_name}>"

    def text(self) -> str:
        """Return the text of the file."""
        head = f"# BEATRIX router of class {self.class_name}. Keep it private. Start: beatrix router --class FILE\n"
        return head + files.toml_text(msgspec.to_builtins(self))

    def endpoint(self, part: Part) -> str:
        """Return the endpoints at which one of the routers listens."""
        return self.listen if part is Part.ROBOTS else self.listen_seats

    def access(self, part: Part) -> RouterAccess:
        """Return the accounts and access rules of one router for `open_router`."""
        own = self.own(part)
        trusted = self.authority + "".join(self.certificates[name] for name in own)
        return RouterAccess(
            [*(self._grant(name) for name in own), every_grant(ROUTER)],
            {**{name: self.accounts[name] for name in own}, ROUTER: ROUTER},
            Identity(trusted, self.certificate, self.key),
            self.listen.partition(",")[0] if part is Part.SEATS else "",
            picture_rates(own, self.pictures_hz),
        )

    def account(self) -> Account:
        """Return the account with which a program of the routers' computer may send and receive everything."""
        own = (self.authority, self.certificate, self.key)
        return Account(self.class_name, ROUTER, "robot", self.listen, dt.date.max, *own)

    def own(self, part: Part) -> tuple[str, ...]:
        """Return the accounts that connect to one of the routers."""
        return self.seats if part is Part.SEATS else (names.TEACHER, *self.robots)

    def _grant(self, name: str) -> Grant:
        if name == names.TEACHER:
            return every_grant(name)
        return student_grant(name, self.robots) if name in self.seats else account_grant(name)

    def without(self, gone: Collection[str]) -> RouterFile:
        """Return the file as it were without these accounts."""
        return msgspec.structs.replace(
            self,
            seats=tuple(seat for seat in self.seats if seat not in gone),
            robots=tuple(robot for robot in self.robots if robot not in gone),
        )


def load(path: Path) -> RouterFile:
    """Read a router file or, if `path` is a class file, the router file of that class.

    Raises:
        WrongUsage: BAD_VALUE, the file cannot be read or is invalid, or `beatrix classroom init` was not run after the
            last change of the class file.
    """
    try:
        table = files.toml(path, LONGEST)
    except OSError as error:
        raise wrong_usage(f"{path} cannot be read: {error}.") from error
    if "role" in table:
        try:
            return msgspec.convert(table, RouterFile)
        except msgspec.ValidationError as error:
            raise wrong_usage(
                f"{path} is not a router file of this version: {error}. Run `beatrix classroom init` again."
            ) from error
    classroom, made = read(path), place(path)
    init = f"`{typed('beatrix', 'classroom', 'init', path)}`"
    if not made.is_file():
        raise wrong_usage(f"Class {classroom.name} has no accounts yet: {made} is missing. Run {init} first.")
    file = load(made)
    shared = ("listen", "listen_seats", "seats", "robots")
    changed = any(getattr(file, name) != getattr(classroom, name) for name in shared)
    if changed or file.pictures_hz != classroom.router.pictures_hz:
        raise wrong_usage(
            f"{path} has changed since the accounts were made. Run {init} again; it keeps existing accounts."
        )
    return file


def place(path: Path) -> Path:
    """Return the path of the router file of a class file; a router file's own path. Raises the errors of `load`."""
    return path if "role" in files.toml(path, LONGEST) else folder(path, read(path)) / "router.toml"


ANY = "*"
STATE = keys.positions(ANY, ANY).rpartition("/")[0] + "/**"
READS = (STATE, keys.info(ANY, ANY), keys.clock(ANY, ANY), keys.program(ANY, ANY))
"""Keys of queries that change nothing."""
TOKENS = tuple(
    row.key
    for row in keys.KEYS.values()
    if row.kind == "token" and ("{robot}" in row.key or "{who}" in row.key)
)
"""Keys of the tokens that belong to an account; that of the router of the seats is its own."""


def account_grant(name: str, drives: tuple[str, ...] = ()) -> Grant:
    """Return the grant to read everything, stop every robot, serve and drive the robot `name`, and query `drives`.

    The account drives its own robot, too, under its own seat only: otherwise it could act there as the teacher.
    """
    stop = keys.stop(ANY, ANY, name)
    # STOP of all robots, under this name. No other key ends like this one, so `**` permits nothing else.
    stops = (stop, stop.replace(f"{ANY}/{ANY}", "**"))
    state = keys.positions(name, ANY).rpartition("/")[0] + "/**"
    return Grant(
        name,
        puts=(state, keys.arm_target(name, ANY, ANY), keys.target(name), *stops),
        queries=(_commands(name, name), *_scenes(name), *READS, *stops, *drives),
        serves=(*below(f"{ROOT}/{name}"), keys.program(name, ANY)),
        subscribes=below(ROOT),
        tokens=tuple(token for key in TOKENS for token in _own_tokens(key, name)),
        watches=EVERYTHING,
    )


def student_grant(seat: str, robots: tuple[str, ...]) -> Grant:
    """Return the grant of `account_grant`, and to drive the robots of the class under this seat and change their scenes.

    A student may also record, send notes to all recordings, report lessons and share gestures, under this seat, and
    read the gestures of the teacher.
    """
    scenes = tuple(key for robot in robots for key in _scenes(robot))
    notes = keys.note(seat, ANY)
    shared = keys.gesture(names.TEACHER, ANY)
    own = account_grant(seat, (*(_commands(robot, seat) for robot in robots), *scenes, notes, shared))
    puts = (*own.puts, keys.lesson(seat, ANY), keys.gesture(seat, ANY))
    return replace(own, serves=(*own.serves, keys.note(ANY, ANY)), puts=puts)


def every_grant(name: str) -> Grant:
    """Return the grant of all keys."""
    return Grant(name, *(EVERYTHING,) * 6)


def _commands(robot: str, seat: str) -> str:
    """Return the key expression of all requests of one seat to both robots of a name."""
    return keys.command(robot, ANY, seat).rpartition("/")[0] + "/**"


def _scenes(robot: str) -> tuple[str, ...]:
    """Return the keys that change the scene of a simulation."""
    return keys.target(robot), keys.sound(robot)


def _own_tokens(key: str, name: str) -> list[str]:
    """Return the key expressions of the tokens of this seat if the key has a seat, else of both robots of this name."""
    own = "who" if "{who}" in key else "robot"
    fields = dict.fromkeys(("robot", "side", "who", "session", "token"), ANY)
    sides = names.SIDES if "{side}" in key else (ANY,)
    return [key.format_map({**fields, "side": side, own: name}) for side in sides]


def picture_rates(robots: tuple[str, ...], pictures_hz: float) -> dict[str, float]:
    """Return, for the key of each camera, the largest rate (Hz) at which the router passes on its pictures."""
    return {
        keys.camera(robot, side, view): pictures_hz
        for robot in robots
        for side in names.SIDES
        for view in names.VIEWS
    }
