"""`beatrix up`: router, simulation and robot in one terminal."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.listing import states, troubles
from beatrix_zenoh.cli.options import Connect, Json, OwnName
from beatrix_zenoh.cli.processes import Fleet, heard
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.cli.verb import document, note, say
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, Settings, resolve

WATCH_S = 0.2
TITLES = {"sim": "simulation", "hw": "hardware"}
FIRST = ("enable", "calibrate")
NEXT = ("look --yaw 20", "top", "stop")
BOTH = " --on both"


def up(
    hw: Annotated[
        str | None,
        typer.Option(metavar="PORT", help="Serve the robot on this serial port too, or on `virtual:`."),
    ] = None,
    no_sim: Annotated[bool, typer.Option("--no-sim", help="No simulation.")] = False,
    ready: Annotated[
        bool, typer.Option("--ready", help="The simulation starts with motors on and calibrated.")
    ] = False,
    name: OwnName = None,
    connect: Connect = None,
    as_json: Json = False,
) -> None:
    """Start router, simulation and robot at once.

    The router only if none answers yet, the robot only with --hw. Ctrl-C ends what was started.
    """
    settings = resolve(name, connect)
    if no_sim and hw is None:
        raise typer.BadParameter("with --no-sim there is only a robot to serve: say where with --hw PORT.")
    with heard(), Fleet() as fleet:
        rows = [("router", settings.connect, start_router(fleet, settings.connect))]
        where = ("--name", settings.robot, "--connect", settings.connect)
        served = {}
        if not no_sim:
            fleet.start(TITLES["sim"], "sim", *where, *(["--ready"] if ready else []))
            served["sim"] = "ready" if ready else "motors off"
        if hw is not None:
            fleet.start(TITLES["hw"], "hw", *where, "--port", hw)
            served["hw"] = hw
        fleet.wait_ready()
        wrong = amiss(settings)
        for twin, how in served.items():
            rows.append((TITLES[twin], settings.robot, ": ".join(filter(None, (how, wrong.get(twin))))))
        with until_told():
            if as_json:
                document({
                    "result": True,
                    "endpoint": settings.connect,
                    "robot": settings.robot,
                    "running": [child.title for child in fleet.children],
                    "warnings": [f"{TITLES[twin]}: {wrong[twin]}" for twin in served if wrong.get(twin)],
                    "logs": str(fleet.folder),
                })  # fmt: skip
            else:
                say(columns(("what", "where", ""), rows))
                both = BOTH if len(served) > 1 else ""
                first = [] if ready and not both else [verb + both for verb in FIRST]
                say(advice(settings.connect, [*first, NEXT[0] + both, *NEXT[1:]], fleet.folder))
            stay(fleet)


def start_router(fleet: Fleet, endpoint: str) -> str:
    """Start one if none answers; what there was to do.

    Raises:
        NoAnswer: NO_ROUTER, and the address is another computer's.
    """
    if answers(endpoint):
        return "was there already"
    if not zbus.ours(endpoint):
        port = endpoint.rpartition(":")[2]
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"No router at {endpoint}, and that is another computer: start one there with "
            f"`beatrix router --listen tcp/0.0.0.0:{port}`, or leave out --connect to have all of it here.",
        )
    fleet.start("router", "router", "--listen", endpoint)
    fleet.wait_ready()
    return "started"


def answers(endpoint: str) -> bool:
    """Something accepts connections there."""
    try:
        zbus.probe(endpoint)
    except NoAnswer:
        return False
    return True


def amiss(settings: Settings) -> dict[str, str]:
    """What is wrong with the robots of this name, by twin."""
    with zbus.connect(settings.connect, label=settings.who) as bus:
        found = states(bus)
    return {twin: " ".join(troubles(found[name, twin])) for name, twin in found if name == settings.robot}


def advice(endpoint: str, verbs: Sequence[str], logs: Path) -> str:
    """What to type next, and where."""
    lines = [f"  beatrix {words}" for words in verbs]
    if endpoint != DEFAULT_ENDPOINT:
        lines.insert(0, f"  {'set' if os.name == 'nt' else 'export'} BEATRIX_CONNECT={endpoint}")
    typed = "\n".join(lines)
    return f"\nNow type in another terminal:\n{typed}\n\nWhat they write is in {logs}. Ctrl-C here ends them all."


@contextlib.contextmanager
def until_told() -> Iterator[None]:
    """Ctrl-C or SIGTERM in here is how this is meant to end."""
    try:
        yield
    except KeyboardInterrupt:
        note("Ending.")


def stay(fleet: Fleet) -> NoReturn:
    """Until somebody interrupts; raises Refused if a child ends by itself."""
    while True:
        fleet.check()
        time.sleep(WATCH_S)
