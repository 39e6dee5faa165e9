"""`beatrix compare`: measure the difference between simulation and hardware."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.files import new_file
from beatrix_zenoh.output import FAILED, note, print_json, progress_bar, say
from beatrix_zenoh.recording.verbs.files import only, read_recording
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.shutdown import signals_interrupt
from beatrix_zenoh.terminal.options import Connect, Json, Name, Which, Who, finite
from beatrix_zenoh.terminal.targets import open_robots

if TYPE_CHECKING:  # importing numpy would delay `beatrix --help` by 0.1 s
    from beatrix_zenoh.recording.compare import Comparison
    from beatrix_zenoh.recording.series import Recording

LIVE = "live"
Seconds = Annotated[
    float,
    typer.Option(
        min=1.5,
        max=600.0,
        callback=finite,
        help="Live: length of the measurement, seconds. For a longer one use `beatrix record`.",
    ),
]
MaxLag = Annotated[
    float | None, typer.Option(metavar="S", help="Fail above this lag of the set points, seconds.")
]
MaxRms = Annotated[
    float | None, typer.Option(metavar="DEG", help="Fail above this RMS difference after lag removal.")
]
MaxLargest = Annotated[
    float | None,
    typer.Option(metavar="DEG", help="Fail above this difference at any time after lag removal."),
]
MaxRest = Annotated[
    float | None, typer.Option(metavar="DEG", help="Fail above this difference while both are at rest.")
]
MaxMissed = Annotated[
    int | None,
    typer.Option(
        metavar="N", help="Live: fail above this number of full motor steps missed in the simulation."
    ),
]


def compare(
    source: Annotated[
        str, typer.Argument(metavar="[FILE.rrd|live]", help="A recording, or `live`: the robots online.")
    ] = LIVE,
    seconds: Seconds = 10.0,
    max_lag: MaxLag = None,
    max_rms: MaxRms = None,
    max_largest: MaxLargest = None,
    max_rest: MaxRest = None,
    max_missed: MaxMissed = None,
    png: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Plot both movements and their difference into this file."),
    ] = None,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Compare simulation and hardware, live or from a recording. Prints lag, differences and, if live, missed steps.

    Live: start the command, then move both robots. The exit code is 1 if a threshold (--max-...) is exceeded; the
    output names each exceeded threshold.
    docs/how-to/compare.md explains the figures.
    """
    from beatrix_zenoh.recording.compare import Thresholds
    from beatrix_zenoh.recording.verbs.comparison_text import as_document, text

    thresholds = Thresholds(max_lag, max_rms, max_largest, max_rest, max_missed)
    sim, hw = live(resolve(name, connect, who), seconds) if source == LIVE else recorded(Path(source), name)
    found = compared(source, sim, hw)
    if png is not None:
        draw(png, found, f"{sim.place[0]}: simulation and hardware")
    exceeded = thresholds.exceeded(found)
    if as_json:
        print_json(as_document(found, exceeded))
    else:
        say(text(found, exceeded))
    if exceeded:
        raise typer.Exit(FAILED)


def compared(source: str, sim: Recording, hw: Recording) -> Comparison:
    """Compare both robots; raises Refused if their recordings have too little time in common."""
    from beatrix_zenoh.recording.compare import compare

    try:
        return compare(sim, hw)
    except ValueError as error:
        raise bad_value(f"{source}: {error}. Record or measure for longer.") from error


def live(settings: Settings, seconds: float) -> tuple[Recording, Recording]:
    """Measure both robots of a name; raises NoAnswer if one is not online."""
    from beatrix_zenoh.recording.series import record_robots

    title = "Measuring: move both robots"
    with open_robots(settings, Which.BOTH) as robots, progress_bar(title, seconds) as bar:
        if bar is None:
            note(f"Measuring for {seconds:g} s: move both robots.")
        sim, hw = record_robots(robots, seconds, bar or (lambda _passed_s: None))
    return sim, hw


def recorded(path: Path, name: str | None) -> tuple[Recording, Recording]:
    """Return both robots of a name from a recording; raises Refused if the recording lacks either."""
    from beatrix_zenoh.recording.series import of_samples

    found = read_recording(path)
    if found.about is not None:
        for text in (found.about.heading(), *found.about.warnings()):
            note(text)
    both = [place for place in found.robots if {(place[0], side) for side in SIDES} <= found.robots.keys()]
    chosen, _ = only(both, name, "sim", "simulation and hardware of")
    begin_ns = int(found.robots[chosen, "sim"].time_ns[0])
    sim, hw = (
        replace(
            of_samples(found.robots[chosen, side], begin_ns, found.events.get((chosen, side), ())),
            place=(chosen, side),
        )
        for side in SIDES
    )
    return sim, hw


def draw(path: Path, found: Comparison, title: str) -> None:
    """Write the plot, completely or not at all; raises Refused if it cannot be drawn or written."""
    try:
        from beatrix_zenoh.recording.plot import twin_figure
    except ModuleNotFoundError as error:
        raise bad_value(
            f"--png needs {error.name}. Run `beatrix install plot`.",
        ) from error
    if path.suffix.lower() != ".png":
        raise bad_value(f"--png {path}: the name must end in .png.")
    with signals_interrupt(), new_file(path) as unfinished:
        twin_figure(found, title).savefig(unfinished, dpi=150)
    note(f"The plot is in {path}.")
