"""`beatrix up`: router, simulation and robot in one terminal."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh.cli.listing import look_up, problems, state
from beatrix_zenoh.cli.options import Connect, Json, Legacy, LogFile, OwnName, RobotFile
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated.messages import Status
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.motion.robot_file import load
from beatrix_zenoh.output import columns, note, print_json, say
from beatrix_zenoh.processes import Child, Role, Supervisor, start_router
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, Settings, resolve
from beatrix_zenoh.shutdown import Shutdown, signals_interrupt

POLL_S = 0.2
WINDOW = "window"
FIRST = ("enable", "calibrate")
NEXT = ("look --yaw 20", "top", "stop")
BOTH = " --on both"


@dataclass(frozen=True)
class UpOptions:
    """Options of `beatrix up`: the processes to start, and the arguments of each."""

    served: Mapping[str, str]
    """the sides to serve, each with its place: MuJoCo, or the port of the board"""
    ready: bool
    legacy: Path | None
    robot_file: Path | None
    log_file: Path | None
    target: str | None
    window: bool

    def arguments(self, side: str) -> list[str]:
        """Return the arguments of the process of one side."""
        words = ["--port", self.served[side]] if side == "hw" else ["--ready"] * self.ready
        if side == "sim" and self.target is not None:
            words += ["--target", self.target]
        if self.robot_file is not None:
            words += ["--robot-file", str(self.robot_file)]
        if self.legacy is not None and side == legacy_side(self.served):
            words += ["--legacy", str(self.legacy)]
        if self.log_file is not None:
            words += ["--log-file", str(log_of(self.log_file, side))]
        return words


def up(
    hw: Annotated[
        str | None,
        typer.Option(
            metavar="PORT", help="Also serve the robot on this serial port, or a virtual board: `virtual:`."
        ),
    ] = None,
    no_sim: Annotated[bool, typer.Option("--no-sim", help="Start no simulation.")] = False,
    ready: Annotated[
        bool, typer.Option("--ready", help="Start the simulation with motors on and calibrated.")
    ] = False,
    target: Annotated[
        str | None,
        typer.Option(
            metavar="MOVEMENT",
            help="Movement of the person in front of the simulated eyes: still, sway or circle.",
        ),
    ] = None,
    gui: Annotated[
        bool, typer.Option("--gui", help="Also open the window. Closing it does not end the robots.")
    ] = False,
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    log_file: LogFile = None,
    name: OwnName = None,
    connect: Connect = None,
    as_json: Json = False,
) -> None:
    """Start router, simulation and robot together.

    Starts the router only if none answers yet, the robot only with --hw, and the window only with --gui. With --legacy,
    programs of 2023 drive the robot, or the simulation if there is no robot. With --log-file day.log, the simulation
    writes day-sim.log, and the robot day-hw.log. A simulation or robot that crashes is started again, once a minute at
    most; the others continue. Ctrl-C, or the end of the router, ends all processes that were started.
    """
    settings = resolve(name, connect)
    if no_sim and hw is None:
        raise typer.BadParameter("With --no-sim there is nothing to start except a robot: add --hw PORT.")
    if no_sim and ready:
        raise typer.BadParameter(
            "--ready is for the simulation. On a robot use enable and calibrate, within sight of it."
        )
    load(robot_file)  # raises before any process starts
    places = {"sim": None if no_sim else "MuJoCo", "hw": hw}
    served = {side: place for side, place in places.items() if place is not None}
    options = UpOptions(served, ready, legacy, robot_file, log_file, target, gui)
    with signals_interrupt() as shutdown, Supervisor() as supervisor:
        router = start_router(supervisor, settings.connect, settings.account)
        start_robots(supervisor, settings, options)
        report(supervisor, settings, options, router, shutdown, as_json=as_json)


def start_robots(supervisor: Supervisor, settings: Settings, options: UpOptions) -> None:
    """Start simulation, robot and window, and wait until they are ready.

    The window is started first, because it ends after the robots.
    """
    where = ("--name", settings.robot, "--connect", settings.connect)
    if options.window:
        open_window(supervisor, settings)
    for side in options.served:
        supervisor.start(SIDE_TITLES[side], side, *where, *options.arguments(side), role=Role.ROBOT)
    supervisor.wait_ready()


def report(
    supervisor: Supervisor,
    settings: Settings,
    options: UpOptions,
    router: str,
    shutdown: Shutdown,
    *,
    as_json: bool,
) -> None:
    """Print the running processes, then their output until Ctrl-C; raises Refused if the router ends."""
    with Client(settings, announce=False) as client:
        found = {robot.place: robot.status for robot in look_up(client)}
        supervisor.new_lines()  # discards the output so far: the table shows the state and the warnings
    running = {child.title for child in supervisor.children}
    own = {side: found.get((settings.robot, side)) for side in options.served if SIDE_TITLES[side] in running}
    with end_on_interrupt():
        if as_json:
            show_json(supervisor, settings, options, own)
        else:
            show(settings, options, router, own, window=WINDOW in running)
            others = any(robot != settings.robot for robot, _ in found)
            by_name = f" --name {settings.robot}" if others else ""
            say(advice(settings.connect, verbs(by_name, own), supervisor.folder))
        watch(supervisor, shutdown)


def legacy_side(sides: Container[str]) -> str:
    """Return the side that programs of 2023 drive: the hardware if it is served, otherwise the simulation."""
    return "hw" if "hw" in sides else "sim"


def log_of(log_file: Path, side: str) -> Path:
    """Return the log file of one side: `day-sim.log` for `day.log`."""
    return log_file.with_name(f"{log_file.stem}-{side}{log_file.suffix}")


def show_json(
    supervisor: Supervisor, settings: Settings, options: UpOptions, own: Mapping[str, Status | None]
) -> None:
    """Print the running processes and the warnings as JSON."""
    legacy = None if options.legacy is None else str(options.legacy.absolute())
    print_json({
        "result": True,
        "endpoint": settings.connect,
        "robot": settings.robot,
        "running": [child.title for child in supervisor.children],
        "legacy": None if legacy is None else {"path": legacy, "side": legacy_side(own)},
        "warnings": warnings(own),
        "logs": str(supervisor.folder),
    })  # fmt: skip


def show(
    settings: Settings, options: UpOptions, router: str, own: Mapping[str, Status | None], *, window: bool
) -> None:
    """Print a table of the running processes, and the warnings below it."""
    rows = [("router", "", settings.connect, router)]
    for side, status in own.items():
        text = "does not answer" if status is None else state(status)
        rows.append((SIDE_TITLES[side], settings.robot, options.served[side], text))
    if window:
        rows.append((WINDOW, settings.robot, "this screen", "open"))
    say(columns(("what", "name", "where", "state"), rows))
    for line in warnings(own):
        say(line)
    if options.legacy is not None:
        say(
            f"Programs of 2023 open {options.legacy.absolute()} and drive the {SIDE_TITLES[legacy_side(own)]}."
        )


def warnings(own: Mapping[str, Status | None]) -> list[str]:
    """Return faults and warnings, a line for each robot that has any."""
    return [
        f"{SIDE_TITLES[side]}: {' '.join(found)}"
        for side, status in own.items()
        if (found := problems(status))
    ]


def verbs(by_name: str, own: Mapping[str, Status | None]) -> list[str]:
    """Return the commands to type next.

    `enable` and `calibrate` are only for robots that are not known to be calibrated, because `calibrate` declares the
    present position home.
    """
    uncalibrated = [side for side, status in own.items() if status is None or not status.calibrated]
    one = f" --on {uncalibrated[0]}" if len(uncalibrated) == 1 < len(own) else ""
    both = BOTH if len(own) > 1 else ""
    first = [verb + by_name + (one or both) for verb in FIRST if uncalibrated]
    return [*first, NEXT[0] + by_name + both, NEXT[1], NEXT[2] + by_name]


def open_window(supervisor: Supervisor, settings: Settings) -> Child:
    """Start a window that shows one robot; wait for it with `wait_ready`."""
    where = ("--name", settings.robot, "--connect", settings.connect)
    return supervisor.start(WINDOW, "gui", *where, role=Role.WINDOW)


def advice(endpoint: str, verbs: Sequence[str], logs: Path) -> str:
    """Return a text with the commands to type next, and the folder with the output of the children."""
    lines = [f"  beatrix {words}" for words in verbs]
    if endpoint != DEFAULT_ENDPOINT:
        lines.insert(0, f"  {'set' if os.name == 'nt' else 'export'} BEATRIX_CONNECT={endpoint}")
    typed = "\n".join(lines)
    return f"\nNow type in another terminal:\n{typed}\n\nThe output of all processes is in {logs}. Ctrl-C here ends them."


@contextlib.contextmanager
def end_on_interrupt() -> Iterator[None]:
    """Print a note instead of raising KeyboardInterrupt: Ctrl-C and SIGTERM are the normal end of the block."""
    try:
        yield
    except KeyboardInterrupt:
        note("Ending.")


def watch(supervisor: Supervisor, shutdown: Shutdown, last: Child | None = None) -> None:
    """Print the output of the children and start crashed robots again, until Ctrl-C.

    Args:
        supervisor: the supervisor of the children.
        shutdown: the value of `signals_interrupt`.
        last: return when this child has ended; None: only Ctrl-C ends the function.

    Raises:
        Refused: a required child has ended.
    """
    while last is None or last.code is None:
        for line in (*supervisor.tend(), *supervisor.new_lines()):
            note(line)
        if shutdown.requested(POLL_S):
            raise KeyboardInterrupt
