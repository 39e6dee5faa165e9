"""Which robot, which router, which seat: argument, environment, beatrix.toml, default, in this order."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from beatrix_zenoh import names
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import WrongUsage

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
FILE = "beatrix.toml"
FIELDS = ("robot", "connect", "who")


@dataclass(frozen=True)
class Settings:
    """Robot name, router endpoint and seat of a client or a node."""

    robot: str
    connect: str
    who: str


def resolve(robot: str | None = None, connect: str | None = None, who: str | None = None) -> Settings:
    """Fill in what was not given from BEATRIX_ROBOT, BEATRIX_CONNECT, BEATRIX_WHO, then ./beatrix.toml.

    Raises:
        WrongUsage: BAD_VALUE, for a name that cannot stand in a key or a file that cannot be read.
    """
    settings, wrong = usable(robot, connect, who)
    if wrong:
        raise wrong[0]
    return settings


def usable(
    robot: str | None = None, connect: str | None = None, who: str | None = None
) -> tuple[Settings, list[WrongUsage]]:
    """As `resolve`, for STOP, in whose way no setting may stand: what can mean nothing counts as not given, and why."""
    given = {"robot": robot, "connect": connect, "who": who}
    environment = {field: os.environ.get(f"BEATRIX_{field.upper()}") for field in FIELDS}
    wrong: list[WrongUsage] = []
    stored: dict[str, str] = {}
    try:
        stored = _stored()
    except WrongUsage as error:
        wrong.append(error)

    def value(field: str, check: Callable[[str], str], default: str) -> str:
        try:
            return check(given[field] or environment[field] or stored.get(field) or default)
        except WrongUsage as error:
            wrong.append(error)
            return default

    settings = Settings(
        robot=value("robot", names.check_name, names.default_robot()),
        connect=value("connect", str, DEFAULT_ENDPOINT),
        who=value("who", names.check_seat, names.default_seat()),
    )
    return settings, wrong


def _stored() -> dict[str, str]:
    path = Path(FILE)
    if not path.is_file():
        return {}
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, OSError) as error:
        raise WrongUsage(Reason.BAD_VALUE, f"{path.resolve()} cannot be read: {error}.") from error
    unknown = set(table) - set(FIELDS)
    if unknown or not all(isinstance(value, str) for value in table.values()):
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"{path.resolve()}: allowed are {', '.join(FIELDS)}, each a text; it holds {', '.join(table)}.",
        )
    return {field: str(value) for field, value in table.items()}
