"""`beatrix doctor`: check this computer, the router and the robots, and print what to do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

import typer

from beatrix_zenoh.cli.checks import Finding, graphics_probe, this_computer
from beatrix_zenoh.cli.jog import jog
from beatrix_zenoh.cli.options import Connect, Json, Name, Who
from beatrix_zenoh.cli.robot_checks import network
from beatrix_zenoh.cli.targets import Selection
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.output import FAILED, print_json, say
from beatrix_zenoh.settings import resolve

MARKS = {"ok": "ok", "advice": "-", "todo": "!"}


def doctor(
    by_jog: Annotated[
        bool,
        typer.Option("--jog", help="Turn the arms of the real robot one by one and ask what you see."),
    ] = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Check router, account and robots, then this computer. The exit code is 1 if something must be done."""
    if by_jog:
        jog(Selection(name, connect, who), as_json=as_json)
        return
    settings = resolve(None, connect, who)
    with graphics_probe() as graphics:  # it runs in a process of its own during the checks
        sections = [
            (settings.connect, made("router and robots", network(settings, name))),
            ("this computer", [*made("this computer", this_computer()), graphics()]),
        ]
    findings = [finding for _, section in sections for finding in section]
    wrong = [finding for finding in findings if finding.todo]
    if as_json:
        print_json({"result": not wrong, "findings": [finding.as_row() for finding in findings]})
    else:
        show(sections)
        say("\nNo problems found." if not wrong else f"\n{len(wrong)} to do: see the lines that begin with !")
    if wrong:
        raise typer.Exit(FAILED)


def made(what: str, checks: Iterator[Finding]) -> list[Finding]:
    """Return the findings of checks; an unexpected error becomes the last finding, so that the others are shown."""
    findings: list[Finding] = []
    try:
        findings.extend(checks)  # keeps the findings before an error
    except BeatrixError:
        raise
    except Exception as error:  # noqa: BLE001  # a broken installation may raise anything
        text = f"the check ended with {type(error).__name__}: {error}"
        findings.append(Finding(what, text, "install BEATRIX again; if this remains, report it as a bug"))
    return findings


def show(sections: list[tuple[str, list[Finding]]]) -> None:
    """Print the title of each section, a line for each of its findings, and below that line what to do."""
    width = max(len(finding.what) for _, section in sections for finding in section)
    for title, section in sections:
        say(f"{title}:")
        for finding in section:
            say(f"  {MARKS[finding.state]:<2}  {finding.what:<{width}}  {finding.found}")
            if what_to_do := finding.todo or finding.advice:
                say(f"      {'':<{width}}  -> {what_to_do}")
