"""Verbs that ask once: ls and info."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping

import msgspec

from beatrix_zenoh import codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import FAULT_TEXT, Fault, Info, Status
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.cli.line import Where, on_line
from beatrix_zenoh.cli.options import Connect, Json, Name, On, Who
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.cli.verb import document, say
from beatrix_zenoh.client import Client
from beatrix_zenoh.settings import resolve

ANSWER_S = 1.0
HEADS = ("robot", "on", "state", "driver", "version", "firmware")
OF_THE_BOARD = (Fault.BOARD_LOST, Fault.CONTRACT_MISMATCH)
"""Told in the board's own words, where there are any."""
Place = tuple[str, str]
"""Name and twin of a robot."""


def ls(connect: Connect = None, who: Who = None, as_json: Json = False) -> None:
    """List the robots on line. State, who drives, what is wrong, versions."""
    with Client(resolve(None, connect, who)) as client:
        endpoint = client.bus.endpoint
        statuses, infos = states(client.bus), descriptions(client.bus)
        claims = Counter(client.bus.claims())
        places = sorted({*client.bus.robots(), *statuses}, key=lambda place: (place[0], place[1] != "sim"))
    if as_json:
        rows = [
            as_row(place, statuses.get(place), infos.get(place)) | {"nodes": claims[place]}
            for place in places
        ]
        document({"result": True, "endpoint": endpoint, "robots": rows})
    elif places:
        show(places, statuses, infos)
        for name, twin in places:
            if (nodes := claims[name, twin]) > 1:
                say(
                    f"{name} ({twin}): {nodes} nodes serve under this name and all of them obey: end all but one."
                )
    else:
        say(f"The router at {endpoint} answers, but no robot is on line. Start a simulation: beatrix sim")


def states(bus: Bus) -> dict[Place, Status]:
    """Status of every robot that answers."""
    answers = bus.answers(keys.status("*", "*"), ANSWER_S)
    statuses = [codec.decode_json(answer.payload, Status) for answer in answers]
    return {(status.robot, status.twin): status for status in statuses}


def descriptions(bus: Bus) -> dict[Place, Info]:
    """Info of every robot that answers."""
    answers = bus.answers(keys.info("*", "*"), ANSWER_S)
    infos = [codec.decode_json(answer.payload, Info) for answer in answers]
    return {(info.robot, info.twin): info for info in infos}


def show(places: list[Place], statuses: Mapping[Place, Status], infos: Mapping[Place, Info]) -> None:
    """One line per robot, and below them what a person should know."""
    rows = []
    for name, twin in places:
        status, info = statuses.get((name, twin)), infos.get((name, twin))
        rows.append((
            name,
            twin,
            "does not answer" if status is None else state(status),
            "-" if status is None else status.holder or "nobody",
            "-" if info is None else info.version,
            "-" if info is None else info.firmware or "no board",
        ))  # fmt: skip
    say(columns(HEADS, rows))
    for place in places:
        for trouble in troubles(statuses.get(place)):
            say(f"{place[0]} ({place[1]}): {trouble}")


def state(status: Status) -> str:
    """State in words."""
    if status.fault is not Fault.NONE:
        return f"fault {status.fault}"
    if not status.enabled:
        return "motors off"
    if not status.calibrated:
        return "not calibrated"
    return "moving" if status.moving else "ready"


def troubles(status: Status | None) -> list[str]:
    """What a person should know."""
    if status is None:
        return ["is on line but does not answer: frozen, or its connection is."]
    told = status.fault is Fault.NONE or (status.fault in OF_THE_BOARD and status.warnings)
    return [*([] if told else [FAULT_TEXT[status.fault]]), *status.warnings]


def as_row(place: Place, status: Status | None, info: Info | None) -> dict[str, object]:
    """A robot for JSON."""
    row: dict[str, object] = {"robot": place[0], "on": place[1], "answers": status is not None}
    if status is not None:
        row |= state_row(status)
    if info is not None:
        row |= {"version": info.version, "contract": info.contract, "firmware": info.firmware}
    return row


def state_row(status: Status) -> dict[str, object]:
    """State for JSON."""
    return {
        "state": state(status),
        "enabled": status.enabled,
        "calibrated": status.calibrated,
        "moving": status.moving,
        "driver": status.holder,
        "fault": status.fault,
        "warnings": status.warnings,
    }


def info(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Show versions, limits, commands and keys. What a stranger needs to drive a robot; degrees."""
    with on_line(Where(name, connect, who), on) as line:
        infos = [robot.info() for robot in line.robots()]
    if as_json:
        document({"result": True, "robots": [described(info) for info in infos]})
        return
    for info in infos:
        describe(info)


def limits_deg(info: Info) -> dict[str, float]:
    """Limits in degrees, degrees/s and degrees/s2."""
    return in_degrees(info.limits, info.limits.__struct_fields__)


def geometry_deg(info: Info) -> dict[str, float]:
    """The neck's shape in degrees; empty from a node of a version that does not tell."""
    shape = info.geometry
    if shape is None:
        return {}
    angles = [name for name in shape.__struct_fields__ if name != "hand"]
    return {**in_degrees(shape, angles), "hand": shape.hand}


def in_degrees(values: msgspec.Struct, names: Iterable[str]) -> dict[str, float]:
    """These fields, which are in radians."""
    return {name: round(math.degrees(getattr(values, name)), 3) for name in names}


def described(info: Info) -> dict[str, object]:
    """Info for JSON, angles in degrees."""
    return {
        "robot": info.robot,
        "on": info.twin,
        "version": info.version,
        "contract": info.contract,
        "firmware": info.firmware,
        "steps_per_turn": info.steps_per_turn,
        "arms": info.arms,
        "limits_deg": limits_deg(info),
        "geometry_deg": geometry_deg(info),
        "fingerprint": info.fingerprint,
        "commands": info.commands,
        "reasons": info.reasons,
        "keys": info.keys,
        "examples": info.examples,
    }


def describe(info: Info) -> None:
    """Info for people."""
    limits = limits_deg(info)
    say(
        f"{info.robot} ({info.twin}), beatrix-zenoh {info.version}, firmware {info.firmware or 'none: no board'}"
    )
    say(
        f"limits: head tilts up to {limits['tilt_max']:g}°, turns up to {limits['yaw_max']:g}° either way; "
        f"arms stay {limits['gap_min']:g}° apart"
    )
    say(
        f"speed: {limits['speed_default']:g}°/s unless told otherwise, at most {limits['speed_max']:g}°/s; "
        f"{limits['acceleration']:g}°/s2; one arm turn is {info.steps_per_turn:.1f} microsteps"
    )
    if shape := geometry_deg(info):
        say(f"neck: at home the short arm points {shape['arm0_azimuth']:g}° to the left of straight ahead")
    say("\ncommands:\n  " + "\n  ".join(info.commands))
    say("\n" + columns(("key", "kind", "what for"), [(row.key, row.kind, row.doc_) for row in info.keys]))
    say("\nexamples, for any Zenoh program (rad):\n  " + "\n  ".join(info.examples))
