"""`beatrix demo`: simulation and robot make the same movement, are recorded and compared, in less than a minute."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from importlib import util
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.files import new_file
from beatrix_zenoh.output import FAILED, note, print_json, say, typed
from beatrix_zenoh.processes import (
    PYTHON,
    Role,
    Supervisor,
    advice,
    beatrix,
    end_on_interrupt,
    free_port,
    open_in_browser,
    watch,
)
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import signals_interrupt
from beatrix_zenoh.terminal.options import Json

if TYPE_CHECKING:
    from beatrix_zenoh.client.choreography import Step

ROBOT = "demo"
RECORDING, PLOT, PICTURE = "demo.rrd", "compare.png", "demo.png"
REST_DEG = "0.5"
"""Largest difference at rest (deg) that counts as the same movement; a full motor step is 0.7 deg of an arm."""
SETTLE_S = 0.5
"""Time at rest before and after the movement (s)."""
NEEDED = {"hw": "serial", "sim": "mujoco"}
"""The extras without which there are no robots, each with a module of it."""
NEXT = ("look --yaw 20 --on both", "top", "stop")
CLI = (*PYTHON, "beatrix_zenoh.cli")


def demo(
    keep: Annotated[bool, typer.Option("--stay", help="Keep both robots running until Ctrl-C.")] = False,
    gui: Annotated[
        bool,
        typer.Option("--gui", help="Show both robots in the window, and run until the window is closed."),
    ] = False,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for recording and pictures.")] = Path(
        "demo-out"
    ),
    as_json: Json = False,
) -> None:
    """Show simulation and robot moving together.

    Starts a simulation and a second robot, which runs the same firmware on a virtual board. Both nod, shake and look
    around. With a display a browser shows them, and you drive them until Ctrl-C; without one, or with --json, there is
    a picture. The demo records both, and compares them as `beatrix compare` does. It needs no robot, no display and no
    network. The exit code is 1 if the movements differ or a file could not be written.
    """
    check_extras()
    make_folder(out)
    with signals_interrupt() as shutdown, Supervisor() as supervisor:
        settings = start(supervisor)
        where = ("--name", ROBOT, "--connect", settings.connect)
        window = supervisor.start("window", "gui", *where, role=Role.WINDOW) if gui else None
        page = None if gui or as_json or not has_display() else start_page(supervisor, *where)
        supervisor.wait_ready()
        if page is not None:
            keep = show_page(page) or keep
        recording = perform(supervisor, settings, out / PICTURE)
        good = show_result(recording, out, as_json=as_json)
        if keep or window is not None:
            supervisor.new_lines()  # discards the output so far, because the comparison contains its results
            with end_on_interrupt():
                note(advice(settings.connect, NEXT, supervisor.folder))
                last = None if keep else window
                if last is not None:
                    note("The robots run until the window is closed.")
                watch(supervisor, shutdown, last)
        else:
            note(f"\nTo drive both robots yourself: {typed(beatrix(), 'up', '--hw', 'virtual:', '--gui')}")
    if not good:
        raise typer.Exit(FAILED)


def show_result(recording: Path | None, out: Path, *, as_json: bool) -> bool:
    """Keep recording and comparison in a folder, and print where they are; return whether both robots moved alike."""
    if recording is None:
        if as_json:
            print_json({"result": True, "message": "Both made the movement. It was not recorded."})
        return True
    with new_file(out / RECORDING) as unfinished:
        shutil.copyfile(recording, unfinished)
    good = compared(out, as_json=as_json)
    note(f"\nThe recording: {typed('beatrix', 'view', str(out / RECORDING))}")
    note(f"A picture of both robots: {out / PICTURE}")
    return good


def check_extras() -> None:
    """Raise Refused (BAD_VALUE) if a package is missing without which there are no robots."""
    lacking = [extra for extra, module in NEEDED.items() if util.find_spec(module) is None]
    if lacking:
        command = typed("beatrix", "install", *lacking, "rerun", "web")
        raise bad_value(f"The demo needs {' and '.join(lacking)}. Run `{command}`.")


def make_folder(out: Path) -> None:
    """Make the folder; raises Refused (BAD_VALUE) if that fails."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise bad_value(f"--out {out}: {error.strerror}. Name another folder.") from error


def start(supervisor: Supervisor) -> Settings:
    """Start router, simulation and virtual robot on a free port, wait for the router only, and return the settings."""
    settings = Settings(ROBOT, f"tcp/127.0.0.1:{free_port()}", "visitor")
    note("Starting a router, a simulation, and a second robot: the same firmware on a virtual board.")
    supervisor.start("router", "router", "--listen", settings.connect)
    supervisor.wait_ready()
    where = ("--name", ROBOT, "--connect", settings.connect)
    supervisor.start("simulation", "sim", *where, role=Role.ROBOT)
    supervisor.start("hardware", "hw", *where, "--port", "virtual:", role=Role.ROBOT)
    return settings


def has_display() -> bool:
    """Return whether a browser could show something."""
    return (
        sys.platform in ("win32", "darwin")
        or bool(os.environ.get("DISPLAY"))
        or bool(os.environ.get("WAYLAND_DISPLAY"))
    )


def start_page(supervisor: Supervisor, *where: str) -> str | None:
    """Start the page of both robots on a free port, and return its address; None if its packages are missing."""
    if util.find_spec("tornado") is None:
        note("To see both robots in your browser: beatrix install web")
        return None
    port = free_port()
    supervisor.start("page", "web", *where, "--port", str(port))
    return f"http://127.0.0.1:{port}/"


def show_page(address: str) -> bool:
    """Open the page in the browser of the user; return whether there is one."""
    if not open_in_browser(address):
        note(f"Both robots are at {address}, but there is no browser on this computer.")
        return False
    note(f"Both robots are at {address}: drive them there, after the demo.")
    return True


def perform(supervisor: Supervisor, settings: Settings, picture: Path) -> Path | None:
    """Record and draw both robots while they play a choreography; return the recording, or None without Rerun.

    Raises:
        Refused, Interrupted, NoAnswer: from the first step that failed, or the picture cannot be written.
    """
    from beatrix_zenoh.client.choreography import play, shipped  # here: `beatrix --help` imports this module
    from beatrix_zenoh.client.twin import Twin

    path, recorder = supervisor.folder / RECORDING, None
    with Twin(ROBOT, connect=settings.connect, who=settings.who) as twin:
        twin.make_ready()
        if util.find_spec("rerun") is None:
            note("The demo continues without a recording and a picture. For both: beatrix install rerun")
        else:
            where = ("--name", ROBOT, "--connect", settings.connect)
            recorder = supervisor.start("recorder", "record", str(path), *where)
            supervisor.wait_ready()
        with twin.sim.log() as sim, twin.hw.log() as hw:
            begun, parts = time.monotonic(), dict[str, float]()

            def show(title: str, _pose: Step) -> None:
                if title not in parts:
                    note(f"Both: {title}.")
                    parts[title] = time.monotonic() - begun

            time.sleep(SETTLE_S)
            play(twin, shipped("demo"), show)
            time.sleep(SETTLE_S)
    if recorder is None:
        return None
    from beatrix_zenoh.demo.picture import write_picture  # here: Pillow comes with Rerun

    write_picture(picture, {"Simulation": sim, "Hardware": hw}, parts)
    supervisor.finish(recorder)
    return path


def compared(out: Path, *, as_json: bool) -> bool:
    """Run `beatrix compare` on the recording in a folder, and return whether both robots made the same movement."""
    plot = ("--png", str(out / PLOT)) if util.find_spec("matplotlib") is not None else ()
    words = ("compare", str(out / RECORDING), "--max-rest", REST_DEG, *plot)
    note("\n" + typed("beatrix", *words))
    done = subprocess.run(
        [*CLI, *words, *(["--json"] if as_json else [])], stdin=subprocess.DEVNULL, check=False
    )
    same = done.returncode == 0
    if not as_json:
        limit = (
            f"their arms are at most {REST_DEG}° apart" if same else f"see above ({REST_DEG}° are allowed)"
        )
        say(f"\nBoth {'made' if same else 'did NOT make'} the same movement: at rest {limit}.")
    return same
