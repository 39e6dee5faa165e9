"""`beatrix demo`: what it is, in less than a minute."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.choreography import Choreography, Pose, shipped
from beatrix_zenoh.cli.options import Json
from beatrix_zenoh.cli.processes import Fleet, heard
from beatrix_zenoh.cli.up import advice, stay, until_told
from beatrix_zenoh.cli.verb import FAILED, document, note, say
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.twin import Twin

if TYPE_CHECKING:
    from beatrix_zenoh.compare import Comparison

ROBOT = "demo"
NEXT = ("look --yaw 20 --on both", "top", "stop")


def demo(
    keep: Annotated[bool, typer.Option("--stay", help="Leave both robots running until Ctrl-C.")] = False,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Where picture, plot and table go.")] = Path(
        "demo-out"
    ),
    as_json: Json = False,
) -> None:
    """Show simulation and robot moving together.

    Starts a simulation and a second robot, the same firmware on a virtual board; both nod, shake and
    look around. Records them and tells how far they were apart. Needs no robot, no display and no
    network. Exit code 1 if they did not make the same movement.
    """
    make_folder(out)
    with heard(), Fleet() as fleet:
        settings = start(fleet)
        with Twin(ROBOT, connect=settings.connect, who=settings.who) as twin:
            good = present(twin, out, as_json=as_json)
        if keep:
            with until_told():
                note(advice(settings.connect, NEXT, fleet.folder))
                stay(fleet)
    if not good:
        raise typer.Exit(FAILED)


def make_folder(out: Path) -> None:
    """Before anything starts, so that nobody waits in vain."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Refused(Reason.BAD_VALUE, f"--out {out}: {error.strerror}. Name another folder.") from error


def start(fleet: Fleet) -> Settings:
    """Router, simulation and virtual robot on a free port."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        settings = Settings(ROBOT, f"tcp/127.0.0.1:{probe.getsockname()[1]}", "visitor")
    note("Starting a router, a simulation, and a second robot: the same firmware on a virtual board.")
    fleet.start("router", "router", "--listen", settings.connect)
    fleet.wait_ready()
    where = ("--name", ROBOT, "--connect", settings.connect)
    fleet.start("simulation", "sim", *where)
    fleet.start("hardware", "hw", *where, "--port", "virtual:")
    fleet.wait_ready()
    return settings


def present(twin: Twin, out: Path, *, as_json: bool) -> bool:
    """Play, compare, tell; True if both made the same movement."""
    from beatrix_zenoh.cli import report
    from beatrix_zenoh.cli.show import perform

    choreography = shipped("hello")
    with progress(choreography) as tell:
        done = perform(twin, choreography, tell)
    note("Drawing.")
    comparison = report.compared(done)
    report.write_csv(out / "demo.csv", comparison)
    files = [str(out / "demo.csv"), *plot(out / "demo.png", comparison), *portrait(out / "head.png")]
    found = report.reported(done, comparison, files)
    if as_json:
        document(msgspec.to_builtins(found))
    else:
        say(f"\n{report.text(found)}")
    return found.result


def plot(path: Path, comparison: Comparison) -> list[str]:
    """Draw both movements; the path, or nothing without matplotlib."""
    try:
        from beatrix_zenoh.plot import twin_figure
    except ModuleNotFoundError as error:
        note(f'No plot: it needs {error.name}. pip install ".[plot]" in the folder of BEATRIX')
        return []
    twin_figure(comparison, "One movement, two robots").savefig(path, dpi=150)
    return [str(path)]


def portrait(path: Path) -> list[str]:
    """Draw the simulated head; the path, or nothing and why."""
    from beatrix_zenoh.cli.report import draw_head

    why_not = draw_head(path)
    if why_not:
        note(f"No picture of the head: {why_not}")
        return []
    return [str(path)]


@contextmanager
def progress(choreography: Choreography) -> Iterator[Callable[[str, Pose], None]]:
    """A bar on a terminal, else a line for every figure; both on stderr."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        titles: list[str] = []

        def tell_line(title: str, _pose: Pose) -> None:
            if title not in titles:
                titles.append(title)
                note(f"Both: {title}.")

        yield tell_line
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("Calibrating", total=len(choreography.steps))

        def tell_bar(title: str, pose: Pose) -> None:
            angles = f"yaw {pose.yaw:+3.0f}°  pitch {pose.pitch:+3.0f}°  roll {pose.roll:+3.0f}°"
            bar.update(task, advance=1, description=f"{title:<12} {angles}")

        yield tell_bar
