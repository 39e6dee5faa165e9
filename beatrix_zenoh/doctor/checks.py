"""The checks of `beatrix doctor` from the router to each robot; `computer` has those on this computer."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from beatrix_zenoh.account import days_left, today
from beatrix_zenoh.client.monitor import Monitor
from beatrix_zenoh.client.robot_base import clock_offsets
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.twin import unlike
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import CONTRACT, Fault, Info, Reason, Status
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer
from beatrix_zenoh.contract.values import grouped, lines
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.terminal.states import ListedRobot, listed, problems, state


class CheckResult(NamedTuple):
    """A result of one check. The user must do `todo` and may follow `advice`; both may be empty."""

    what: str
    found: str
    todo: str = ""
    advice: str = ""

    @property
    def state(self) -> str:
        """One of ok, advice and todo."""
        return "todo" if self.todo else "advice" if self.advice else "ok"

    def as_row(self) -> dict[str, str]:
        """Return the fields of the finding, for JSON output."""
        return {**self._asdict(), "state": self.state}


OFFSET_S = 0.05
"""Largest clock offset without advice (s); with a larger offset the times of two robots are hard to compare."""
RATE_S = 0.6
"""Time over which the rate of positions is measured (s)."""
SLOW = 0.9
"""Fraction of the contract's rate of positions; a lower rate is reported."""


def network(settings: Settings, name: str | None = None) -> Iterator[CheckResult]:
    """Yield findings about router, account and robots; stop after the first step that fails.

    If no robot of the name `name` is online, one of the findings says so.
    """
    own = settings.account
    if own is not None and (days_left(own.expires, today()) or 0) < 0:
        yield CheckResult("account", f"{own.name} of class {own.class_name}, expired", own.renewal(today()))
        return
    try:
        client = Client(settings)
    except NoAnswer as error:
        what = "account" if error.reason is Reason.ACCOUNT_REFUSED else "router"
        yield CheckResult(what, "is refused" if what == "account" else "does not answer", error.message)
        return
    with client:
        yield CheckResult("router", "answers")
        try:
            account = accepted(client)
            yield account
            if not account.todo:
                yield from robots(client, name)
        except NoAnswer as error:
            yield CheckResult("router", "was lost during the checks", error.message)


def accepted(client: Client) -> CheckResult:
    """Return a finding about the account with which the router has accepted this session."""
    account = client.settings.account
    if account is None:
        return CheckResult("account", "none: this router is open to every program")
    refused = client.bus.connection_error()
    if refused is not None:
        return CheckResult("account", "is refused", refused.message)
    found = f"{account.name} of class {account.class_name}, accepted, valid until {account.expires}"
    return CheckResult("account", found, advice=account.renewal(today()))


def robots(client: Client, name: str | None) -> Iterator[CheckResult]:
    """Yield findings about every robot online, and about the robot `name` if it is not online."""
    with Monitor(client) as monitor:
        began_s = time.monotonic()
        found = listed(client, monitor)
        if name is not None and all(robot.place[0] != name for robot in found):
            yield missing(name, [str(robot) for robot in found])
        elif not found:
            yield CheckResult("robots", "none online", advice="to start one: beatrix sim, or beatrix up")
        if not found:
            return
        time.sleep(max(0.0, began_s + RATE_S - time.monotonic()))
        rates = {robot.place: monitor.robot(*robot.place).hz for robot in found}
    for robot in found:
        yield from one_robot(client, robot, rates[robot.place])
    yield from unlike_sides({robot.place: robot.info for robot in found if robot.info is not None})


def missing(name: str, others: list[str]) -> CheckResult:
    """Return the finding about a robot that is not online; `others` are online."""
    found = f"not online; online: {', '.join(others) or 'no robot'}"
    return CheckResult(name, found, "look at the output of its node, or start it: beatrix sim or beatrix hw")


def one_robot(client: Client, listed_robot: ListedRobot, hz: float) -> Iterator[CheckResult]:
    """Yield findings about a robot; `hz` is its rate of positions."""
    name, status = str(listed_robot), listed_robot.status
    text = " ".join(problems(status))
    if status is None:
        yield CheckResult(name, "online, but does not answer", text)
        return
    well = status.fault is Fault.NONE
    yield CheckResult(
        name, f"answers, {state(status)}", todo="" if well else text, advice=text if well else ""
    )
    yield rate(name, hz)
    yield clock(client, listed_robot)
    if listed_robot.info is not None:
        yield contract(name, listed_robot.info)
    yield from devices(name, status)


def rate(name: str, hz: float) -> CheckResult:
    """Return a finding about the rate of positions (Hz)."""
    slow = "end other programs on its computer and on this one, or use a cable instead of Wi-Fi"
    advice = slow if hz < SLOW * keys.positions.rate_hz else ""
    return CheckResult(name, f"{hz:.0f} positions a second of {keys.positions.rate_hz}", advice=advice)


def contract(title: str, info: Info) -> CheckResult:
    """Return a finding about whether the robot has the same messages and keys as this computer."""
    same = info.contract == CONTRACT
    return CheckResult(
        title,
        f"version {info.version}, {'same messages' if same else 'other messages'} ({info.contract}), firmware "
        f"{info.firmware or 'none'}",
        "" if same else "install the same version of beatrix-zenoh on both",
    )


def devices(name: str, status: Status) -> Iterator[CheckResult]:
    """Yield findings about what is connected to the robot: its board, and each camera and other sensor.

    `one_robot` reports why no board is connected.
    """
    about = lines(status)
    for group, members in grouped(status).items():
        found = {one.field.rpartition(".")[2]: one.value for one in members}
        if "connected" not in found or (group == "board" and not status.board.connected):
            continue
        trouble = "" if found["connected"] else f"plug in what belongs to `{group}`"
        yield CheckResult(name, f"{group}: {about[group]}", str(found.get("trouble") or trouble))


def unlike_sides(infos: Mapping[Place, Info]) -> Iterator[CheckResult]:
    """Yield findings about simulations whose robot values differ from those of the hardware of the same name."""
    for (name, side), info in infos.items():
        hardware = infos.get((name, "hw"))
        if side == "sim" and hardware is not None and unlike(info, hardware):
            yield CheckResult(
                f"{name} (sim, hw)",
                "simulation and hardware run with different values",
                "start both with the same --robot-file, or without one",
            )


def clock(client: Client, robot: ListedRobot) -> CheckResult:
    """Return a finding about the offset of the robot's wall clock from that of this computer."""
    try:
        offset, bound = clock_offsets(client, *robot.place).wall
    except BeatrixError as error:
        return CheckResult(str(robot), "clock offset unknown", error.message)
    ahead = "ahead" if offset > 0 else "behind"
    text = f"its clock is {abs(offset) * 1e3:.2f} ms {ahead} (+- {bound * 1e3:.2f} ms)"
    far = abs(offset) > OFFSET_S + bound
    return CheckResult(str(robot), text, advice="to compare times, set both clocks (NTP)" if far else "")
