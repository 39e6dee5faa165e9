"""Verbs that run programs: router, sim, hw, gui, web, flash, model; `up` runs several in one terminal."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.cli.listing import show
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.motion.robot_file import load
from beatrix_zenoh.output import say
from beatrix_zenoh.processes import Role, Supervisor, advice, end_on_interrupt, start_router, watch
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, Settings, resolve
from beatrix_zenoh.shutdown import Shutdown, signals_interrupt
from beatrix_zenoh.terminal.options import Connect, Legacy, LogFile, OwnName, RobotFile
from beatrix_zenoh.terminal.run import missing
from beatrix_zenoh.terminal.states import ListedRobot, look_up

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


def model(context: typer.Context) -> None:
    """Write the robot as MJCF or URDF for other programs. `beatrix model --help` lists its options."""
    raise typer.Exit(run("model", context.args))


def run(process: str, arguments: list[str]) -> int:
    """Run a program of the entry point group PROCESSES in this process and return its exit code.

    Raises:
        Refused: BAD_VALUE, the program or a package that it needs is not installed.
    """
    entries = metadata.entry_points(group=PROCESSES, name=process)
    if not entries:
        raise bad_value(
            f"`beatrix {process}` is newer than the installation. Run `make demo` in the folder of BEATRIX, which renews it."
        )
    try:
        main = next(iter(entries)).load()
    except ModuleNotFoundError as error:
        raise missing(process, error) from error
    code: int = main(arguments)
    return code


Port = Annotated[
    str | None,
    typer.Option(
        metavar="PORT", help="Also serve the robot on this serial port, or a virtual board: `virtual:`."
    ),
]
Movement = Annotated[
    str | None,
    typer.Option(
        metavar="MOVEMENT",
        help="Movement of the person in front of the simulated eyes: still, sway or circle.",
    ),
]
TITLES = {"gui": "window", **SIDE_TITLES}
"""The titles of the programs that `up` starts, by their verbs."""


def up(
    hw: Port = None,
    no_sim: Annotated[bool, typer.Option("--no-sim", help="Start no simulation.")] = False,
    ready: Annotated[
        bool, typer.Option("--ready", help="Start the simulation with motors on and calibrated.")
    ] = False,
    target: Movement = None,
    gui: Annotated[
        bool, typer.Option("--gui", help="Also open the window. Closing it does not end the robots.")
    ] = False,
    of_class: Annotated[
        Path | None,
        typer.Option(
            "--class", metavar="FILE", help="Start router, simulations and page of this class file."
        ),
    ] = None,
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    log_file: LogFile = None,
    name: OwnName = None,
    connect: Connect = None,
) -> None:
    """Start router, simulation and robot together.

    Starts the router only if none answers yet, the robot only with --hw, and the window only with --gui. With --legacy,
    programs of 2023 drive the robot, or the simulation if there is no robot. With --log-file day.log, the simulation
    writes day-sim.log, and the robot day-hw.log. A simulation or robot that crashes is started again, once a minute at
    most; the others continue. Ctrl-C, or the end of the router, ends all processes that were started.
    With --class, --hw serves the first robot of the class.
    """
    if of_class is not None:
        up_class(of_class, hw, (no_sim, ready, target, gui, legacy, robot_file, log_file, name, connect))
        return
    settings = resolve(name, connect)
    if no_sim and (ready or hw is None):
        raise typer.BadParameter(
            "With --no-sim give --hw PORT; type enable and calibrate within sight of the robot."
        )
    load(robot_file)  # raises before any process starts
    options = {} if no_sim else {"sim": ["--ready"] * ready + given("--target", target)}
    options |= {} if hw is None else {"hw": given("--port", hw)}
    programs: dict[str, list[str]] = {"gui": []} if gui else {}
    for side, words in options.items():
        programs[side] = words + given("--robot-file", robot_file) + log_words(log_file, side)
    programs[[*programs][-1]] += given("--legacy", legacy)
    run_programs(settings, programs, legacy)


def up_class(file: Path, hw: str | None, others: Sequence[object]) -> None:
    """Start a whole class; `others` are the options that must not be given with it."""
    if any(others):
        raise typer.BadParameter("With --class give only --hw: names and router are those of the class.")
    try:
        from beatrix_zenoh.classroom import up as whole_class
    except ModuleNotFoundError as error:
        raise missing("classroom", error) from error
    whole_class.run(file, hw)


def run_programs(settings: Settings, programs: Mapping[str, Sequence[str]], legacy: Path | None) -> None:
    """Run programs, and a router if none answers, until Ctrl-C; print the robots, and what to type next."""
    with signals_interrupt() as shutdown, Supervisor() as supervisor:
        router = start_router(supervisor, settings.connect, settings.account)
        start_programs(supervisor, settings, programs)
        with Client(settings, announce=False) as client:
            found = look_up(client)
        supervisor.new_lines()  # discards the output so far: the table shows the state and the warnings
        with end_on_interrupt():
            say(f"router {settings.connect}: {router}")
            show(found)
            if legacy is not None:
                say(f"Programs of 2023 open {legacy.absolute()} and drive the {TITLES[[*programs][-1]]}.")
            say(advice(settings.connect, verbs(settings.robot, found), supervisor.folder))
            watch(supervisor, shutdown)


def given(option: str, value: object) -> list[str]:
    """Return an option and its value as arguments of a program; nothing if the value is None."""
    return [] if value is None else [option, str(value)]


def log_words(log_file: Path | None, side: str) -> list[str]:
    """Return the option with the log file of one side: `day-sim.log` for `day.log`."""
    return [] if log_file is None else ["--log-file", str(log_file.with_stem(f"{log_file.stem}-{side}"))]


def start_programs(supervisor: Supervisor, settings: Settings, programs: Mapping[str, Sequence[str]]) -> None:
    """Start programs by their verbs, each with its arguments, and wait until they are ready; the last one ends first."""
    for verb, words in programs.items():
        role = Role.WINDOW if verb == "gui" else Role.ROBOT
        where = ("--name", settings.robot, "--connect", settings.connect)
        supervisor.start(TITLES[verb], verb, *where, *words, role=role)
    supervisor.wait_ready()


def verbs(name: str, found: Sequence[ListedRobot]) -> list[str]:
    """Return the commands to type next to the robot of this name, if these robots are online.

    `enable` and `calibrate` are only for robots that are not known to be calibrated, because `calibrate` declares the
    present position home.
    """
    own = [robot for robot in found if robot.place[0] == name]
    by_name = f" --name {name}" if len(own) < len(found) else ""
    both = " --on both" if len(own) > 1 else ""
    new = [robot.place[1] for robot in own if robot.status is None or not robot.status.calibrated]
    on = both if len(new) == len(own) else f" --on {new[0]}" if new else ""
    first = [f"enable{by_name}{on}", f"calibrate{by_name}{on}"] if new else []
    return [*first, f"look --yaw 20{by_name}{both}", "top", f"stop{by_name}"]
