"""`beatrix doctor`: what works here and at the router, and what to do about the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import CONTRACT, Fault, Info
from beatrix_zenoh.cli.checks import Finding, this_computer
from beatrix_zenoh.cli.clocks import clock_offset
from beatrix_zenoh.cli.jog import jog
from beatrix_zenoh.cli.line import Where
from beatrix_zenoh.cli.listing import Place, descriptions, state, states, troubles
from beatrix_zenoh.cli.options import Connect, Json, Name, Who
from beatrix_zenoh.cli.verb import FAILED, document, say
from beatrix_zenoh.client import Client
from beatrix_zenoh.errors import BeatrixError, NoAnswer
from beatrix_zenoh.robot import Robot
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.twin import unlike

OFFSET_S = 0.05
"""Clocks further apart than this make times of two robots hard to compare."""


def doctor(
    by_jog: Annotated[
        bool,
        typer.Option("--jog", help="Turn the arms of the real robot one by one, and ask what you see."),
    ] = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Find out what is wrong. Packages, graphics, ports, router, robots; exit code 1 if something must be done."""
    if by_jog:
        jog(Where(name, connect, who), as_json=as_json)
        return
    settings = resolve(None, connect, who)
    sections = [("this computer", list(this_computer())), (settings.connect, list(network(settings)))]
    findings = [finding for _, section in sections for finding in section]
    wrong = [finding for finding in findings if finding.todo]
    if as_json:
        document({"result": not wrong, "findings": [finding._asdict() for finding in findings]})
    else:
        show(sections)
        say("\nAll is well." if not wrong else f"\n{len(wrong)} to do: see the lines that begin with !")
    if wrong:
        raise typer.Exit(FAILED)


def show(sections: list[tuple[str, list[Finding]]]) -> None:
    """A line each, and what to do below it."""
    width = max(len(finding.what) for _, section in sections for finding in section)
    for title, section in sections:
        say(f"{title}:")
        for finding in section:
            mark = "!" if finding.todo else "-" if finding.advice else "ok"
            say(f"  {mark:<2}  {finding.what:<{width}}  {finding.found}")
            if what_to_do := finding.todo or finding.advice:
                say(f"      {'':<{width}}  -> {what_to_do}")


def network(settings: Settings) -> Iterator[Finding]:
    """Router and robots."""
    try:
        zbus.probe(settings.connect)
        with Client(settings) as client:
            yield Finding("router", "answers")
            yield from robots(client)
    except NoAnswer as error:
        yield Finding("router", "does not answer", error.message)


def robots(client: Client) -> Iterator[Finding]:
    """Every robot on line: state, contract, clock."""
    places, infos, statuses = client.bus.robots(), descriptions(client.bus), states(client.bus)
    if not places:
        yield Finding("robots", "none on line", advice="to start one: beatrix sim, or beatrix up")
    for name, twin in places:
        title = f"{name} ({twin})"
        status, info = statuses.get((name, twin)), infos.get((name, twin))
        if status is None or info is None:
            yield Finding(title, "on line, but does not answer", "end it and start it again")
            continue
        told = " ".join(troubles(status))
        well = status.fault is Fault.NONE
        yield Finding(title, state(status), todo="" if well else told, advice=told if well else "")
        yield contract(title, info)
        yield clock(Robot(name, twin, client=client))
    yield from unlike_twins(infos)


def contract(title: str, info: Info) -> Finding:
    """Say whether it speaks our language."""
    if info.contract == CONTRACT:
        return Finding(title, f"version {info.version}, same messages, firmware {info.firmware or 'none'}")
    return Finding(
        title,
        f"version {info.version} speaks contract {info.contract}, this computer {CONTRACT}",
        "install the same version of beatrix-zenoh on both",
    )


def unlike_twins(infos: Mapping[Place, Info]) -> Iterator[Finding]:
    """Simulations that are of another robot than the hardware of their name."""
    for (name, twin), info in infos.items():
        hardware = infos.get((name, "hw"))
        if twin == "sim" and hardware is not None and unlike(info, hardware):
            yield Finding(
                f"{name} (sim, hw)",
                "simulation and hardware run with different values",
                "start both with the same --robot-file, or without one",
            )


def clock(robot: Robot) -> Finding:
    """How far its wall clock is from ours."""
    try:
        offset, bound = clock_offset(robot)
    except BeatrixError as error:
        return Finding(str(robot), "clock not known", error.message)
    ahead = "ahead" if offset > 0 else "behind"
    text = f"its clock is {abs(offset) * 1e3:.2f} ms {ahead} (+- {bound * 1e3:.2f} ms)"
    if abs(offset) > OFFSET_S + bound:
        return Finding(str(robot), text, advice="to compare times, set both clocks (NTP)")
    return Finding(str(robot), text)
