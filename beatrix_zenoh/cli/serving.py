"""Verbs that run programs: router, sim, hw, gui, web, flash; `up` runs several in one terminal."""

from __future__ import annotations

import sys
from collections.abc import Container, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated.messages import Reason, Status
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.motion.robot_file import load
from beatrix_zenoh.output import columns, print_json, say
from beatrix_zenoh.processes import Child, Role, Supervisor, advice, end_on_interrupt, start_router, watch
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, Settings, resolve
from beatrix_zenoh.shutdown import Shutdown, signals_interrupt
from beatrix_zenoh.terminal.options import Connect, Json, Legacy, LogFile, OwnName, RobotFile
from beatrix_zenoh.terminal.run import install, missing
from beatrix_zenoh.terminal.states import look_up, problems, state

PROCESSES = "beatrix.processes"
"""Group of entry points of the programs in sim_node, hw_node and gui, which this package must not import."""
OPEN_FILES = 10_240
"""Open files of a router where the system sets no limit; macOS permits no more."""


def router(
    listen: Annotated[
        str | None,
        typer.Option(
            metavar="ENDPOINT",
            help=f"Address that robots and programs connect to; default: that of the class, or {DEFAULT_ENDPOINT}.",
        ),
    ] = None,
    of_class: Annotated[
        Path | None,
        typer.Option(
            "--class", metavar="FILE", help="Accept only the accounts of this class file (or router file)."
        ),
    ] = None,
) -> None:
    """Run the router. Robots, simulations and programs connect to it.

    Ends with Ctrl-C. With --listen tcp/0.0.0.0:7447 it also accepts other computers, and every program in the network
    may send every request. In a network with other people use --class, after `beatrix classroom init`.
    """
    if of_class is not None and listen is not None:
        raise typer.BadParameter(
            "The router of a class listens at the addresses in class.toml: leave out --listen."
        )
    shutdown = Shutdown()
    shutdown.handle_signals()
    _allow_connections()
    if of_class is not None:
        from beatrix_zenoh.classroom import routers
        from beatrix_zenoh.lesson_files import names

        routers.run(of_class, names(), shutdown)
        return
    listen = listen or DEFAULT_ENDPOINT
    session = zbus.open_router(listen)
    try:
        say(f"ready {listen}")
        shutdown.wait()
    finally:
        zbus.close_router(session)


def _allow_connections() -> None:
    """Raise the limit of open files to what the system permits: each connection is one, and 256 or 1024 is usual."""
    if sys.platform == "win32":
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OPEN_FILES if hard == resource.RLIM_INFINITY else hard
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, wanted), hard))


def sim(context: typer.Context) -> None:
    """Simulate a robot. `beatrix sim --help` lists its options."""
    raise typer.Exit(run("sim", context.args))


def hw(context: typer.Context) -> None:
    """Serve a real robot, or a virtual board. `beatrix hw --help` lists its options."""
    raise typer.Exit(run("hw", context.args))


def gui(context: typer.Context) -> None:
    """Open the window that drives and shows both robots. `beatrix gui --help` lists its options."""
    raise typer.Exit(run("gui", context.args))


def web(context: typer.Context) -> None:
    """Serve a page that drives robots from a browser. `beatrix web --help` lists its options."""
    raise typer.Exit(run("web", context.args))


def flash(context: typer.Context) -> None:
    """Write the firmware to an Arduino Mega. `beatrix flash --help` lists its options."""
    raise typer.Exit(run("flash", context.args))


def run(process: str, arguments: list[str]) -> int:
    """Run a program of the entry point group PROCESSES in this process and return its exit code.

    Raises:
        Refused: BAD_VALUE, the program or a package that it needs is not installed.
    """
    entries = metadata.entry_points(group=PROCESSES, name=process)
    if not entries:
        raise Refused(Reason.BAD_VALUE, f"`beatrix {process}` is not installed. {install(process)}")
    try:
        main = next(iter(entries)).load()
    except ModuleNotFoundError as error:
        raise missing(process, error) from error
    code: int = main(arguments)
    return code


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
