"""The file of the router of a class, with all data that the router needs."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.bus.credentials import Identity
from beatrix_zenoh.bus.router import RouterAccess
from beatrix_zenoh.classroom import rules
from beatrix_zenoh.classroom.class_file import Classroom, read
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage

ROUTER = "@router"
"""Common name in the certificate of the router; no account can have it."""
LONGEST = 256 * 1024
"""Largest size of a router file (bytes)."""


class RouterFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The fields of a router file."""

    class_name: str = msgspec.field(name="class")
    role: Literal["router"]
    listen: str
    seats: tuple[str, ...]
    robots: tuple[str, ...]
    pictures_hz: float
    authority: str
    certificate: str
    key: str
    accounts: dict[str, str]
    """common name of the newest certificate of each account"""

    def __repr__(self) -> str:
        """Return role and class without the secrets."""
        return f"<router of class {self.class_name}>"

    def text(self) -> str:
        """Return the text of the file."""
        head = f"# BEATRIX router of class {self.class_name}. Keep it private. Start: beatrix router --class FILE\n"
        return head + files.toml_text(msgspec.to_builtins(self))

    def access(self) -> RouterAccess:
        """Return the accounts and access rules for `open_router`."""
        return RouterAccess(
            rules.grants(self.seats, self.robots),
            self.accounts,
            Identity(self.authority, self.certificate, self.key),
            rules.picture_rates(self.seats, self.robots, self.pictures_hz),
        )


def folder(path: Path, classroom: Classroom) -> Path:
    """Return the folder of the files of a class: beside its class file, under the name of the class."""
    return path.parent / classroom.name


def load(path: Path) -> RouterFile:
    """Read a router file or, if `path` is a class file, the router file of that class.

    Raises:
        WrongUsage: BAD_VALUE, the file cannot be read or is invalid, or `beatrix classroom init` was not run after the
            last change of the class file.
    """
    try:
        table = files.toml(path, LONGEST)
    except OSError as error:
        raise _wrong(f"{path} cannot be read: {error}.") from error
    if "role" in table:
        try:
            return msgspec.convert(table, RouterFile)
        except msgspec.ValidationError as error:
            raise _wrong(
                f"{path} is not a router file of this version: {error}. Run `beatrix classroom init` again."
            ) from error
    classroom, made = read(path), place(path)
    init = f"`beatrix classroom init {path}`"
    if not made.is_file():
        raise _wrong(f"Class {classroom.name} has no accounts yet: {made} is missing. Run {init} first.")
    file = load(made)
    known = (file.listen, file.seats, file.robots, file.pictures_hz)
    if known != (classroom.listen, classroom.seats, classroom.robots, classroom.pictures_hz):
        raise _wrong(
            f"{path} has changed since the accounts were made. Run {init} again; it keeps existing accounts."
        )
    return file


def place(path: Path) -> Path:
    """Return the path of the router file of a class file; a router file's own path. Raises the errors of `load`."""
    return path if "role" in files.toml(path, LONGEST) else folder(path, read(path)) / "router.toml"


def _wrong(text: str) -> WrongUsage:
    return WrongUsage(Reason.BAD_VALUE, text)
