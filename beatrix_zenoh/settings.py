"""Settings of a client or a node, from argument, environment, beatrix.toml, account or default, in this order."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from beatrix_zenoh import account, files
from beatrix_zenoh.account import Account
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract.errors import WrongUsage, wrong_usage

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
FILE = "beatrix.toml"
LONGEST = 64 * 1024
"""Largest size of this file (bytes)."""
CAMERAS = {eye: f"camera_{eye}" for eye in names.EYES}
FIELDS = ("robot", "connect", "who", "account", *CAMERAS.values(), "microphones")


@dataclass(frozen=True)
class Settings:
    """Robot name, router endpoint, seat, cameras and microphones of a robot, and account."""

    robot: str
    connect: str
    who: str
    cameras: tuple[str, ...] = ()
    """`EYE=SOURCE`, as for `beatrix hw --camera`"""
    microphones: str = ""
    """source, as for `beatrix hw --microphones`; empty: none"""
    account: Account | None = None
    """name and credentials for the router of a class; None: no account"""
    named: bool = True
    """whether argument, environment or beatrix.toml has a valid name; otherwise `robot` is the account's or a default"""

    def shown(self, seat: str) -> str:
        """Return a seat with the name of its pupil, if the teacher's account has it."""
        return seat if self.account is None else self.account.shown(seat)


def resolve(robot: str | None = None, connect: str | None = None, who: str | None = None) -> Settings:
    """Return the settings of a program.

    Missing arguments are taken from the environment (BEATRIX_ROBOT and so on, see FIELDS), from ./beatrix.toml, from
    the account, or from the defaults, in this order.

    Raises:
        WrongUsage: BAD_VALUE, a name, beatrix.toml or the account is invalid.
    """
    settings, errors = resolve_valid(robot, connect, who)
    if errors:
        raise errors[0]
    return settings


def resolve_valid(
    robot: str | None = None, connect: str | None = None, who: str | None = None
) -> tuple[Settings, list[WrongUsage]]:
    """Return the settings, with defaults for invalid ones, and the errors, because no error may prevent STOP."""
    given = {"robot": robot, "connect": connect, "who": who}
    environment = {field: os.environ.get(f"BEATRIX_{field.upper()}") for field in FIELDS}
    errors: list[WrongUsage] = []
    stored: dict[str, str] = {}
    try:
        stored = _stored()
    except WrongUsage as error:
        errors.append(error)

    try:
        endpoint = connect or environment["connect"] or stored.get("connect")
        own = _account(environment["account"], stored.get("account"), endpoint)
    except WrongUsage as error:
        own = None
        errors.append(error)

    def value(field: str, check: Callable[[str], str], default: str) -> str:
        try:
            return check(given.get(field) or environment[field] or stored.get(field) or default)
        except WrongUsage as error:
            errors.append(error)
            return default

    cameras = {eye: value(field, str, "") for eye, field in CAMERAS.items()}
    wanted = robot or environment["robot"] or stored.get("robot")
    name = value("robot", names.check_name, (own and own.robot) or names.default_robot())
    settings = Settings(
        robot=name,
        connect=value("connect", str, own.connect if own else DEFAULT_ENDPOINT),
        who=value(
            "who", own.check_seat if own else names.check_seat, own.name if own else names.default_seat()
        ),
        cameras=tuple(f"{eye}={source}" for eye, source in cameras.items() if source),
        microphones=value("microphones", str, ""),
        account=own,
        named=name == wanted,
    )
    return settings, errors


def account_at(endpoint: str) -> Account | None:
    """Return the account that programs use at this router; raises WrongUsage (BAD_VALUE) if its file is invalid."""
    return _account(os.environ.get("BEATRIX_ACCOUNT"), _stored().get("account"), endpoint)


def _account(environment: str | None, stored: str | None, endpoint: str | None) -> Account | None:
    """Return the account in the file that a setting names, else the one that `beatrix join` has stored.

    An account that `beatrix join` has stored is not used for another router. An empty BEATRIX_ACCOUNT means no account.
    """
    if environment is not None:
        return account.load(Path(environment)) if environment else None
    if stored:
        return account.load(Path(stored))
    path = account.joined()
    joined = account.load(path) if path.is_file() else None
    # The account is of no use at another router, for example that of `beatrix demo`, and must not be shown to it.
    ours = joined is not None and endpoint in {None, joined.connect, *joined.connect.split(",")}
    return joined if ours else None


def _stored() -> dict[str, str]:
    path = Path(FILE)
    if not path.is_file():
        return {}
    try:
        table = files.toml(path, LONGEST, str(path.resolve()))
    except OSError as error:
        raise wrong_usage(f"{path.resolve()} cannot be read: {error}.") from error
    unknown = set(table) - set(FIELDS)
    if unknown or not all(isinstance(value, str) for value in table.values()):
        raise wrong_usage(
            f"{path.resolve()} has the fields {', '.join(table)}. Allowed are {', '.join(FIELDS)}, with text values.",
        )
    return {field: str(value) for field, value in table.items()}
