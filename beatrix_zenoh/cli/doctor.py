"""`beatrix doctor`: check this computer, the router and the robots, and print what to do."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import CONTRACT, Fault, Info
from beatrix_zenoh.cli.checks import Finding, this_computer
from beatrix_zenoh.cli.jog import jog
from beatrix_zenoh.cli.listing import look_up, problems, state
from beatrix_zenoh.cli.options import Connect, Json, Name, Who
from beatrix_zenoh.cli.output import FAILED, print_json, say
from beatrix_zenoh.cli.targets import Selection
from beatrix_zenoh.client.clocks import clock_offset
from beatrix_zenoh.client.plan import unlike
from beatrix_zenoh.client.request import Place
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.errors import BeatrixError, NoAnswer
from beatrix_zenoh.settings import Settings, resolve

OFFSET_S = 0.05
"""A larger clock offset makes the times of two robots hard to compare."""


def doctor(
    by_jog: Annotated[
        bool,
        typer.Option("--jog", help="Turn the arms of the real robot one by one and ask you what you see."),
    ] = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Check packages, graphics, ports, router and robots. The exit code is 1 if something must be done."""
    if by_jog:
        jog(Selection(name, connect, who), as_json=as_json)
        return
    settings = resolve(None, connect, who)
    sections = [("this computer", list(this_computer())), (settings.connect, list(network(settings)))]
    findings = [finding for _, section in sections for finding in section]
    wrong = [finding for finding in findings if finding.todo]
    if as_json:
        print_json({"result": not wrong, "findings": [finding._asdict() for finding in findings]})
    else:
        show(sections)
        say("\nNo problems found." if not wrong else f"\n{len(wrong)} to do: see the lines that begin with !")
    if wrong:
        raise typer.Exit(FAILED)


def show(sections: list[tuple[str, list[Finding]]]) -> None:
    """Print a line for each finding, and below it what to do."""
    width = max(len(finding.what) for _, section in sections for finding in section)
    for title, section in sections:
        say(f"{title}:")
        for finding in section:
            mark = "!" if finding.todo else "-" if finding.advice else "ok"
            say(f"  {mark:<2}  {finding.what:<{width}}  {finding.found}")
            if what_to_do := finding.todo or finding.advice:
                say(f"      {'':<{width}}  -> {what_to_do}")


def network(settings: Settings) -> Iterator[Finding]:
    """Findings about the router and its robots."""
    try:
        zbus.probe(settings.connect)
        with Client(settings) as client:
            yield Finding("router", "answers")
            yield from robots(client)
    except NoAnswer as error:
        yield Finding("router", "does not answer", error.message)


def robots(client: Client) -> Iterator[Finding]:
    """Findings about every robot on line: state, contract, clock."""
    found = look_up(client)
    if not found:
        yield Finding("robots", "none on line", advice="to start one: beatrix sim, or beatrix up")
    for robot in found:
        if robot.status is None or robot.info is None:
            yield Finding(str(robot), "on line, but does not answer", "restart it")
            continue
        text = " ".join(problems(robot.status))
        well = robot.status.fault is Fault.NONE
        yield Finding(str(robot), state(robot.status), todo="" if well else text, advice=text if well else "")
        yield contract(str(robot), robot.info)
        yield clock(Robot(*robot.place, client=client))
    yield from unlike_twins({robot.place: robot.info for robot in found if robot.info is not None})


def contract(title: str, info: Info) -> Finding:
    """A finding about whether the robot has the same messages and keys as this computer."""
    if info.contract == CONTRACT:
        return Finding(title, f"version {info.version}, same messages, firmware {info.firmware or 'none'}")
    return Finding(
        title,
        f"version {info.version} has contract {info.contract}, this computer has {CONTRACT}",
        "install the same version of beatrix-zenoh on both",
    )


def unlike_twins(infos: Mapping[Place, Info]) -> Iterator[Finding]:
    """Findings about simulations whose robot values differ from those of the hardware of the same name."""
    for (name, twin), info in infos.items():
        hardware = infos.get((name, "hw"))
        if twin == "sim" and hardware is not None and unlike(info, hardware):
            yield Finding(
                f"{name} (sim, hw)",
                "simulation and hardware run with different values",
                "start both with the same --robot-file, or without one",
            )


def clock(robot: Robot) -> Finding:
    """A finding about the offset of the robot's wall clock from that of this computer."""
    try:
        offset, bound = clock_offset(robot.client, robot.name, robot.twin)
    except BeatrixError as error:
        return Finding(str(robot), "clock offset unknown", error.message)
    ahead = "ahead" if offset > 0 else "behind"
    text = f"its clock is {abs(offset) * 1e3:.2f} ms {ahead} (+- {bound * 1e3:.2f} ms)"
    if abs(offset) > OFFSET_S + bound:
        return Finding(str(robot), text, advice="to compare times, set both clocks (NTP)")
    return Finding(str(robot), text)
