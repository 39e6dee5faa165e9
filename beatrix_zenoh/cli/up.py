"""`beatrix up`: router, simulation and robot in one terminal."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Reason, Status
from beatrix_zenoh.cli.listing import state, states, troubles
from beatrix_zenoh.cli.options import Connect, Json, OwnName, RobotFile
from beatrix_zenoh.cli.processes import Fleet, heard
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.cli.verb import document, note, say
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.robot_file import load
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
    robot_file: RobotFile = None,
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
    if no_sim and ready:
        raise typer.BadParameter(
            "--ready is for the simulation: a robot is made ready by who sees it, with enable and calibrate."
        )
    load(robot_file)  # says what is wrong with it before anything starts
    with heard(), Fleet() as fleet:
        router = start_router(fleet, settings.connect)
        served = start_robots(fleet, settings, hw, robot_file, sim=not no_sim, ready=ready)
        with zbus.connect(settings.connect, label=settings.who) as bus:
            found = states(bus)
            fleet.news()  # what they have said until now is in their states
        own = {twin: found.get((settings.robot, twin)) for twin in served}
        with until_told():
            if as_json:
                tell_json(fleet, settings, own)
            else:
                tell(settings.connect, router, settings.robot, served, own)
                crowded = any(robot != settings.robot for robot, _ in found)
                name_them = f" --name {settings.robot}" if crowded else ""
                say(advice(settings.connect, verbs(name_them, own), fleet.folder))
            stay(fleet)


def start_robots(
    fleet: Fleet, settings: Settings, port: str | None, robot_file: Path | None, *, sim: bool, ready: bool
) -> dict[str, str]:
    """Start simulation and robot, wait until they serve; twin and what its body is."""
    values = () if robot_file is None else ("--robot-file", str(robot_file))
    where = ("--name", settings.robot, "--connect", settings.connect, *values)
    served = {}
    if sim:
        fleet.start(TITLES["sim"], "sim", *where, *(["--ready"] if ready else []))
        served["sim"] = "MuJoCo"
    if port is not None:
        fleet.start(TITLES["hw"], "hw", *where, "--port", port)
        served["hw"] = port
    fleet.wait_ready()
    return served


def tell_json(fleet: Fleet, settings: Settings, own: Mapping[str, Status | None]) -> None:
    """What runs, as JSON."""
    document({
        "result": True,
        "endpoint": settings.connect,
        "robot": settings.robot,
        "running": [child.title for child in fleet.children],
        "warnings": warnings(own),
        "logs": str(fleet.folder),
    })  # fmt: skip


def tell(
    endpoint: str, router: str, robot: str, served: Mapping[str, str], own: Mapping[str, Status | None]
) -> None:
    """What runs, for people, and below it what is wrong."""
    rows = [("router", "", endpoint, router)]
    for twin, where in served.items():
        status = own[twin]
        rows.append((TITLES[twin], robot, where, "does not answer" if status is None else state(status)))
    say(columns(("what", "name", "where", "state"), rows))
    for line in warnings(own):
        say(line)


def warnings(own: Mapping[str, Status | None]) -> list[str]:
    """What a person should know, a line for each robot concerned."""
    return [
        f"{TITLES[twin]}: {' '.join(found)}" for twin, status in own.items() if (found := troubles(status))
    ]


def verbs(name_them: str, own: Mapping[str, Status | None]) -> list[str]:
    """What to type next: nobody who knows home is told to calibrate, which would make another place home."""
    homeless = [twin for twin, status in own.items() if status is None or not status.calibrated]
    one = f" --on {homeless[0]}" if len(homeless) == 1 < len(own) else ""
    both = BOTH if len(own) > 1 else ""
    first = [verb + name_them + (one or both) for verb in FIRST if homeless]
    return [*first, NEXT[0] + name_them + both, NEXT[1], NEXT[2] + name_them]


def start_router(fleet: Fleet, endpoint: str) -> str:
    """Start one if none answers; what there was to do.

    Raises:
        NoAnswer: NO_ROUTER, and the address is another computer's.
    """
    if zbus.listens(endpoint):
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
    """Pass on what the children say until somebody interrupts; raises Refused if one ends by itself."""
    while True:
        fleet.check()
        for line in fleet.news():
            note(line)
        time.sleep(WATCH_S)
