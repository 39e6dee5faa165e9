"""`beatrix demo`: a simulation and a virtual robot make the same movement, in less than a minute."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from beatrix_zenoh.cli.options import Json
from beatrix_zenoh.cli.progress import progress_bar
from beatrix_zenoh.cli.up import advice, end_on_interrupt, open_window, watch
from beatrix_zenoh.client.choreography import Choreography, Step, shipped
from beatrix_zenoh.client.twin.twin import Twin
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.output import FAILED, note, print_json, say
from beatrix_zenoh.processes import Role, Supervisor
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import signals_interrupt

if TYPE_CHECKING:
    from beatrix_zenoh.cli.demo_files import DemoRecording
    from beatrix_zenoh.cli.demo_report import Measurement

ROBOT = "demo"
NEXT = ("look --yaw 20 --on both", "top", "stop")


def demo(
    keep: Annotated[bool, typer.Option("--stay", help="Keep both robots running until Ctrl-C.")] = False,
    gui: Annotated[
        bool,
        typer.Option("--gui", help="Show both robots in the window, and run until the window is closed."),
    ] = False,
    out: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for recording, pictures, plot and table.")
    ] = Path("demo-out"),
    as_json: Json = False,
) -> None:
    """Show simulation and robot moving together.

    Starts a simulation and a second robot, which runs the same firmware on a virtual board. Both nod, shake and look
    around. The demo records both, prints their differences, and opens the recording if there is a display (not with
    --gui, which opens the window). It needs no robot, no display and no network. The exit code is 1 if the movements
    differ or a file could not be written.
    """
    from beatrix_zenoh.cli.demo_files import begin_recording

    make_folder(out)
    with signals_interrupt() as shutdown, Supervisor() as supervisor:
        settings = start(supervisor)
        window = open_window(supervisor, settings) if gui else None
        supervisor.wait_ready()
        with Twin(ROBOT, connect=settings.connect, who=settings.who) as twin:
            recording = begin_recording(supervisor, settings)
            good = present(twin, out, recording, as_json=as_json, show=not gui)
        if keep or window is not None:
            supervisor.new_lines()  # discards the output so far, because the report contains its results
            with end_on_interrupt():
                note(advice(settings.connect, NEXT, supervisor.folder))
                last = None if keep else window
                if last is not None:
                    note("The robots run until the window is closed.")
                watch(supervisor, shutdown, last)
    if not good:
        raise typer.Exit(FAILED)


def make_folder(out: Path) -> None:
    """Make the folder; raises Refused (BAD_VALUE) if that fails."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Refused(Reason.BAD_VALUE, f"--out {out}: {error.strerror}. Name another folder.") from error


def start(supervisor: Supervisor) -> Settings:
    """Start router, simulation and virtual robot on a free port, wait for the router only, and return the settings."""
    from beatrix_zenoh.recording.viewer import HOST, free_port

    settings = Settings(ROBOT, f"tcp/{HOST}:{free_port()}", "visitor")
    note("Starting a router, a simulation, and a second robot: the same firmware on a virtual board.")
    supervisor.start("router", "router", "--listen", settings.connect)
    supervisor.wait_ready()
    where = ("--name", ROBOT, "--connect", settings.connect)
    supervisor.start("simulation", "sim", *where, role=Role.ROBOT)
    supervisor.start("hardware", "hw", *where, "--port", "virtual:", role=Role.ROBOT)
    return settings


def present(twin: Twin, out: Path, recording: DemoRecording | None, *, as_json: bool, show: bool) -> bool:
    """Play, compare and report; return whether both made the same movement and all files were written."""
    from beatrix_zenoh.cli.demo_report import measure

    choreography = shipped("hello")
    with progress(choreography) as show_step:
        done = measure(twin, choreography, show_step)
    if recording is not None:
        recording.finish()
    return conclude(done, out, recording, as_json=as_json, show=show)


def conclude(
    done: Measurement, out: Path, recording: DemoRecording | None, *, as_json: bool, show: bool = True
) -> bool:
    """Write the files and print the report, even if a file could not be written; return the result of `present`."""
    from beatrix_zenoh.cli.demo_files import RECORDING, show_recording, write_files
    from beatrix_zenoh.cli.demo_report import as_text, compare_twins, make_report

    note("Writing the files.")
    comparison = compare_twins(done)
    more = {} if recording is None else recording.writers(done.hw.positions)
    files = write_files(out, comparison, more)
    found = make_report(done, comparison, files)
    if as_json:
        print_json(msgspec.to_builtins(found))
    else:
        say(f"\n{as_text(found)}")
        if show and str(out / RECORDING) in files.written:
            show_recording(out / RECORDING)
    return found.result and not found.unwritten


@contextmanager
def progress(choreography: Choreography) -> Iterator[Callable[[str, Step], None]]:
    """Yield a function that shows a step: in a bar or, if stderr is not a terminal, as a note for each new title."""
    with progress_bar("Calibrating", len(choreography.steps)) as bar:
        titles: list[str] = []

        def show_step(title: str, pose: Step) -> None:
            if bar is not None:
                bar(len(titles), f"{title:<12} {pose}")
            elif title not in titles:
                note(f"Both: {title}.")
            titles.append(title)

        yield show_step
