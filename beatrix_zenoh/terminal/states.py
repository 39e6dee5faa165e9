"""Robots online, and their states and problems as text."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from beatrix_zenoh.account import Account
from beatrix_zenoh.client.monitor import ASK_S, Monitor, Presence
from beatrix_zenoh.client.request import infos as answered_infos
from beatrix_zenoh.client.request import title
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract._generated.messages import Fault, FollowState, Info, Status
from beatrix_zenoh.contract.values import as_data

NAMES, WARNINGS = 12, 12
"""Largest number of names in a line about a robot, and of lines with warnings."""
BOARD_FAULTS = (Fault.BOARD_LOST, Fault.CONTRACT_MISMATCH)
"""Faults that the warnings in a status describe in more detail, if there are any."""

FOLLOWING = {
    FollowState.WAITING: "waits for hw",
    FollowState.APPROACHING: "moves to hw",
    FollowState.FOLLOWING: "follows hw",
    FollowState.PARTED: "parted from hw",
}


class ListedRobot(NamedTuple):
    """A robot online, and its replies, each None if it did not arrive."""

    place: Place
    status: Status | None
    info: Info | None

    def __str__(self) -> str:
        return f"{self.place[0]} ({self.place[1]})"


def look_up(client: Client) -> list[ListedRobot]:
    """Return all robots online, sorted by name; of each name the simulation comes first."""
    with Monitor(client) as monitor:
        return listed(client, monitor)


def listed(client: Client, monitor: Monitor) -> list[ListedRobot]:
    """Return the robots that a monitor reports, with their replies, in the order of `look_up`."""
    begin_s = time.monotonic()
    infos = answered_infos(client)
    monitor.settle(max(0.0, begin_s + ASK_S - time.monotonic()))
    robots = [robot for robot in monitor.robots() if robot.status or robot.presence is not Presence.ABSENT]
    return [
        ListedRobot(place, robot.status, infos.get(place))
        for robot in robots
        for place in [(robot.robot, robot.side)]
    ]


def some(names: Sequence[str], most: int = NAMES) -> str:
    """Return the first names, and the number of the others."""
    others = len(names) - most
    return ", ".join([*names[:most], *([f"and {others} more"] if others > 0 else [])])


def state(status: Status) -> str:
    """Return the state of a robot in one or two words."""
    if status.fault is not Fault.NONE:
        return f"fault {status.fault}"
    if not status.enabled:
        return "motors off"
    if not status.calibrated:
        return "not calibrated"
    if status.frozen:
        return "frozen"
    if status.following is not FollowState.OFF:
        return FOLLOWING.get(status.following, status.following)
    return "moving" if status.moving else "ready"


def problems(status: Status | None) -> list[str]:
    """Return sentences about fault, warnings and lease of a robot; `status` is None if none could be read."""
    if status is None:
        return ["is online but sends no readable status: its node hangs, is cut off, or has another version."]
    found = [*status.warnings[:WARNINGS], *lease_notes(status)]
    if len(status.warnings) > WARNINGS:
        found.append(f"It has {len(status.warnings) - WARNINGS} more warnings.")
    if status.fault is not Fault.NONE and not (status.fault in BOARD_FAULTS and status.warnings):
        found.insert(0, status.fault.text)
    return found


def lease_notes(status: Status) -> list[str]:
    """Return sentences about freeze, lease, waiting seats and speed limit."""
    notes = []
    if status.teacher_latch:
        notes.append("The teacher has pressed EMERGENCY_STOP; only the teacher resets it: beatrix reset")
    if status.frozen:
        notes.append("The teacher has frozen it; only the teacher ends this: beatrix unfreeze")
    if status.muted:
        seats = some(status.muted)
        notes.append(f"The teacher has muted {seats}; only the teacher ends this: beatrix unmute SEAT")
    if status.lease:
        notes.append(f"{status.holder} has taken it.")
    if status.turn_s:
        notes.append(f"This turn ends in {status.turn_s} s.")
    if status.waiting:
        notes.append(f"Waiting for it: {some(status.waiting)}.")
    notes += [f"The arms turn {words}." for words in limit_words(status)]
    return notes


def unlike_notes(statuses: Mapping[Place, Status], account: Account | None) -> list[str]:
    """Return a sentence if decisions of the teacher are in force at some robots only; in a class its own robots count.

    A robot that was not online then does not have them (decision 122).
    """
    decided = {
        title(place): ", ".join(
            [*["frozen"] * status.frozen, *limit_words(status), *(f"{seat} muted" for seat in status.muted)]
        )
        for place, status in statuses.items()
        if account is None or not account.of_seat(place[0])
    }
    if len({*decided.values()}) < 2:
        return []
    words = some([f"{robot} {text or 'none'}" for robot, text in decided.items()])
    return [
        f"The teacher's decisions differ: {words}. `beatrix freeze`, `limit` and `mute` of the teacher reach all."
    ]


def limit_words(status: Status) -> list[str]:
    """Return the speed limit of the teacher in words, if there is one."""
    return [f"at most {math.degrees(status.speed_limit):.0f}°/s"] if status.speed_limit else []


def state_row(status: Status) -> dict[str, object]:
    """Return the state of a robot, its driver and all values of its status, for JSON output."""
    return {"state": state(status), "driver": status.holder, **as_data(status)}
