"""Grants of the accounts of a class, made from the keys of the contract."""

from __future__ import annotations

from dataclasses import replace

from beatrix_zenoh.bus.access_control import EVERYTHING, ROOT, Grant
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys

ANY = "*"
STATE = keys.positions(ANY, ANY).rpartition("/")[0] + "/**"
READS = (STATE, keys.info(ANY, ANY), keys.clock(ANY, ANY), keys.program(ANY, ANY))
"""Keys of queries that change nothing."""
TOKENS = tuple(row.key for row in keys.KEYS.values() if row.kind == "token")


def grants(seats: tuple[str, ...], robots: tuple[str, ...]) -> list[Grant]:
    """Return the grants of all accounts of a class."""
    return [
        teacher(),
        *(student(seat, robots) for seat in seats),
        *(account(robot) for robot in robots),
    ]


def account(name: str, drives: tuple[str, ...] = ()) -> Grant:
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
        queries=(_commands(name, name), keys.target(name), *READS, *stops, *drives),
        serves=(f"{ROOT}/{name}/**", keys.program(name, ANY)),
        subscribes=EVERYTHING[:1],
        tokens=tuple(token for key in TOKENS for token in _own_tokens(key, name)),
        watches=EVERYTHING,
    )


def student(seat: str, robots: tuple[str, ...]) -> Grant:
    """Return the grant of `account`, and to drive the robots of the class under this seat and change their scenes.

    A student may also record, and send notes to all recordings under this seat.
    """
    scenes = tuple(keys.target(robot) for robot in robots)
    notes = keys.note(seat, ANY)
    own = account(seat, (*(_commands(robot, seat) for robot in robots), *scenes, notes))
    return replace(own, serves=(*own.serves, keys.note(ANY, ANY)))


def teacher() -> Grant:
    """Return the grant of the teacher: all keys."""
    return Grant(names.TEACHER, *(EVERYTHING,) * 6)


def _commands(robot: str, seat: str) -> str:
    """Return the key expression of all requests of one seat to both robots of a name."""
    return keys.command(robot, ANY, seat).rpartition("/")[0] + "/**"


def _own_tokens(key: str, name: str) -> list[str]:
    """Return the key expressions of the tokens of this seat if the key has a seat, else of both robots of this name."""
    own = "who" if "{who}" in key else "robot"
    fields = dict.fromkeys(("robot", "side", "who", "session", "token"), ANY)
    sides = names.SIDES if "{side}" in key else (ANY,)
    return [key.format_map({**fields, "side": side, own: name}) for side in sides]


def picture_rates(seats: tuple[str, ...], robots: tuple[str, ...], pictures_hz: float) -> dict[str, float]:
    """Return, for the key of each camera, the largest rate (Hz) at which a session receives its pictures."""
    return {
        keys.camera(robot, side, view): pictures_hz
        for robot in (*robots, *seats, names.TEACHER)
        for side in names.SIDES
        for view in names.VIEWS
    }
