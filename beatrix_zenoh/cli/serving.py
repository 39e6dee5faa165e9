"""Verbs that run a program in this process: router, sim, hw, gui, web, flash."""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.output import say
from beatrix_zenoh.settings import DEFAULT_ENDPOINT
from beatrix_zenoh.shutdown import POLL_S, Shutdown

PROCESSES = "beatrix.processes"
"""Group of entry points of the programs in sim_node, hw_node and gui, which this package must not import."""
OPEN_FILES = 10_240
"""Open files of a router where the system sets no limit; macOS permits no more."""
EXTRAS = {"flash": "hw"}
"""The extra of each program whose extra has another name than the program."""


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
        _class_router(of_class, shutdown)
        return
    listen = listen or DEFAULT_ENDPOINT
    session = zbus.open_router(listen)
    try:
        say(f"ready {listen}")
        shutdown.wait()
    finally:
        session.close()


def _allow_connections() -> None:
    """Raise the limit of open files to what the system permits: each connection is one, and 256 or 1024 is usual."""
    if sys.platform == "win32":
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OPEN_FILES if hard == resource.RLIM_INFINITY else hard
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, wanted), hard))


def _class_router(of_class: Path, shutdown: Shutdown) -> None:
    """Run the router of a class; restart it when `beatrix classroom init` has changed its file.

    Zenoh 1.10 reads its access rules only while it opens.
    """
    from beatrix_zenoh.classroom import router_file

    file = router_file.load(of_class)
    place = router_file.place(of_class)
    seen = place.stat().st_mtime_ns

    def changed() -> router_file.RouterFile | None:
        """Return a file that has changed since the last call; None if it has not or cannot be read."""
        nonlocal seen
        try:
            if (written := place.stat().st_mtime_ns) == seen:
                return None
            found = router_file.load(of_class)
        except (OSError, BeatrixError):
            return None  # the class file has changed, and `init` will follow
        seen = written
        return None if found == file else found

    session = zbus.open_router(file.listen, file.access())
    while True:
        try:
            say(f"ready {file.listen}")
            found = None
            while not (ended := shutdown.requested(POLL_S)) and (found := changed()) is None:
                pass
        finally:
            session.close()
        if ended or found is None:
            return
        say("The accounts have changed: the router restarts.")
        try:
            session, file = zbus.open_router(found.listen, found.access()), found
        except BeatrixError as error:
            say(
                f"The router continues with the former accounts, because it cannot use the new file. {error.message}"
            )
            session = zbus.open_router(file.listen, file.access())


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


def missing(process: str, error: ModuleNotFoundError) -> Refused:
    """Return the refusal for a program that needs a package that is not installed."""
    text = f"`beatrix {process}` needs {error.name}, which is not installed. {install(process)}"
    return Refused(Reason.BAD_VALUE, text)


def install(process: str) -> str:
    """Return a sentence with the command that installs the packages of `beatrix PROCESS`."""
    return f'Run `pip install ".[{EXTRAS.get(process, process)}]"` in the folder of BEATRIX.'
