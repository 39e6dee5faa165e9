"""Accounts of seats and robots in a class: the files that `beatrix classroom init` writes and `beatrix join` stores."""

from __future__ import annotations

import datetime as dt
import tomllib
from pathlib import Path
from typing import Literal

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract.errors import WrongUsage, quoted, wrong_usage

LONGEST = 32 * 1024
"""Largest size of an account file (bytes); one has 2 kB, and the teacher's also the names of 99 pupils."""
RENEW_DAYS = 60
"""`beatrix classroom init` replaces certificates that expire within this time."""
Role = Literal["student", "teacher", "robot"]


class Account(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Name and credentials that a program shows to the router of a class."""

    class_name: str = msgspec.field(name="class")
    name: str
    """name of the seat, and of its own robot"""
    role: Role
    connect: str
    """endpoints of the router, separated by commas"""
    expires: dt.date
    """last day on which the certificate is valid"""
    authority: str
    """certificate (PEM) of the authority that has signed the certificate of the router"""
    certificate: str
    """certificate (PEM); its common name is the name and a random suffix, and the router knows only the newest"""
    key: str
    names: dict[str, str] = {}
    """names of pupils by seat, empty texts for seats without one, only in the file of the teacher: the network transports
    no names of persons"""
    robots: tuple[str, ...] = ()
    """robots of the class, only in the file of the teacher; others belong to seats"""

    def __repr__(self) -> str:
        """Return name and class without the credentials, because logs contain reprs."""
        return f"<account {self.name} of class {self.class_name}>"

    @property
    def robot(self) -> str:
        """Default robot of programs with this account; empty for the teacher, who has none."""
        return "" if self.role == "teacher" else self.name

    def text(self) -> str:
        """Return the text of the account file."""
        fields = msgspec.to_builtins(self)
        head = f"# BEATRIX account {self.name} of class {self.class_name}. Keep it private. To use it: beatrix join FILE\n"
        return head + files.toml_text(fields)

    def shown(self, seat: str) -> str:
        """Return a seat with the name of its pupil, if this account has it."""
        name = self.names.get(seat)
        return f"{name} ({seat})" if name else seat

    def of_seat(self, robot: str) -> bool:
        """Return whether this account knows that a robot of this name belongs to a seat, and not to the class."""
        return bool(self.robots) and robot not in self.robots

    def check_seat(self, seat: str) -> str:
        """Return the seat if this account may use it; otherwise raise WrongUsage (BAD_VALUE)."""
        if self.role == "teacher" or seat == self.name:
            return seat
        raise wrong_usage(
            f"The account of this computer is {self.name}, of class {self.class_name}, and the router refuses its "
            f"requests under the seat {seat}. Leave out --who, BEATRIX_WHO and `who` in beatrix.toml, or join with the "
            f"file of {seat}.",
        )

    def check_muted(self, seat: str) -> None:
        """Raise WrongUsage (BAD_VALUE) if this is the teacher's account and its class has no such student or robot."""
        if self.names and seat not in (*self.names, *self.robots):
            raise wrong_usage(
                f"Class {self.class_name} has no student {quoted(seat)}. Its seats are: {', '.join(map(self.shown, self.names))}.",
            )

    def may_serve(self, robot: str) -> bool:
        """Return whether this account may serve a robot of this name."""
        return self.role == "teacher" or robot == self.name

    def check_served(self, robot: str) -> None:
        """Raise WrongUsage (BAD_VALUE) if this account may not serve a robot of this name."""
        if not self.may_serve(robot):
            raise wrong_usage(
                f"The account of this computer is {self.name}, of class {self.class_name}, and the router accepts only a "
                f"robot of the same name from it, not {robot}. Leave out --name, or use the file of {robot}.",
            )

    def check_time(self, today: dt.date) -> None:
        """Raise WrongUsage (BAD_VALUE) after the certificate's last day."""
        if today > self.expires:
            raise wrong_usage(
                f"{self.renewal(today)} The date of this computer is {today}; if it is wrong, set it instead.",
            )

    def renewal(self, today: dt.date) -> str:
        """Return the sentences of `renewal` for this account."""
        return renewal(self.class_name, self.expires, today, "" if self.role == "teacher" else self.name)


codec.prepare(Account)


def today() -> dt.date:
    """Return the present date in UTC, as in certificates."""
    return dt.datetime.now(dt.UTC).date()


def days_left(expires: dt.date, today: dt.date) -> int | None:
    """Return the days until the last day of a certificate, negative after it; None while `init` would keep it."""
    left = (expires - today).days
    return left if left < RENEW_DAYS else None


def renewal(class_name: str, expires: dt.date, today: dt.date, name: str = "") -> str:
    """Return when the accounts of a class expire, and what to do; empty while `init` would keep them.

    `name`: that of the account of a seat or robot, whose user asks the teacher; empty: for the teacher.
    """
    left = days_left(expires, today)
    if left is None:
        return ""
    subject, verb = (f"Account {name}", "expires") if name else ("All accounts", "expire")
    when = f"expired on {expires}" if left < 0 else f"{verb} on {expires}, in {left} day{'s' * (left != 1)}"
    todo = (
        f"Ask the teacher for a new {name}.toml, then run `beatrix join {name}.toml`."
        if name
        else "The teacher runs `beatrix classroom init class.toml`, copies the new files to all seats and robots, and runs "
        "`beatrix join` with each on its computer; the router then refuses the old ones."
    )
    return f"{subject} of class {class_name} {when}. {todo}"


def joined() -> Path:
    """Return the path of the account that `beatrix join` stores for this user."""
    return files.user_folder() / "account.toml"


def store(account: Account) -> None:
    """Store the account for all programs of this user, as `beatrix join` does; raises OSError if that is impossible."""
    place = joined()
    place.parent.mkdir(parents=True, exist_ok=True)
    files.write_private(place, account.text())


def load(path: Path) -> Account:
    """Read an account file; raises WrongUsage (BAD_VALUE) if it cannot be read or is invalid."""
    try:
        return parse(files.text(path, LONGEST, "TOML"), str(path))
    except OSError as error:
        raise _wrong(str(path), f"it cannot be read ({error.strerror})") from error


def parse(text: str, called: str) -> Account:
    """Parse the text of an account file; raises the errors of `load`."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _wrong(called, f"it is not written in TOML ({error})") from error
    try:
        account = msgspec.convert(table, Account)
    except msgspec.ValidationError as error:
        raise _wrong(called, str(error)) from error
    names.check_name(account.name, "account")
    if not all(endpoint.strip().startswith("tls/") for endpoint in account.connect.split(",")):
        raise _wrong(called, "its router must have endpoints that begin with tls/")
    return account


def _wrong(called: str, text: str) -> WrongUsage:
    return wrong_usage(
        f"{called} is not an account file: {text}. Use the file of your seat or robot, for example ana.toml, from the "
        "folder seats or robots that `beatrix classroom init` makes, or the text of the QR code on the card.",
    )
