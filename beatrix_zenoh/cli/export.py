"""`beatrix export`: write a recording as a table, a film, or both."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.cli.film import FILM, EyeName, check_video, written_film
from beatrix_zenoh.cli.options import Json, Names, Which, finite
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.files import check_new, new_file
from beatrix_zenoh.output import print_json, say
from beatrix_zenoh.shutdown import signals_interrupt

if TYPE_CHECKING:  # importing numpy and rerun would delay every verb
    from beatrix_zenoh.recording.export import Table

RECORDING = ".rrd"
TABLES = (".csv", ".parquet")

Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="RECORDING.rrd... [FILE]",
        help="The recording, all its files if it was rotated, then the table: .csv or .parquet.",
    ),
]
Samples = Annotated[
    bool, typer.Option("--samples", help="Every sample as published, instead of a row every 20 ms.")
]
From = Annotated[
    float,
    typer.Option(
        "--from", min=0.0, metavar="S", callback=finite, help="Begin S seconds after the recording's start."
    ),
]
To = Annotated[
    float | None,
    typer.Option("--to", min=0.0, metavar="S", help="End S seconds after the recording's start."),
]

Video = Annotated[
    Path | None, typer.Option(metavar="FILE.mp4", help="A film of simulation and hardware, or of an eye.")
]
Eye = Annotated[EyeName | None, typer.Option("--eye", help="With --video: the pictures of this eye.")]
On = Annotated[
    Which | None, typer.Option("--on", help="With --eye: of the simulation (sim) or the hardware (hw).")
]


def export(
    files: Files,
    samples: Samples = False,
    begin: From = 0.0,
    end: To = None,
    name: Names = None,
    video: Video = None,
    eye: Eye = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Write a recording as a table (CSV or Parquet), or as a film.

    A row every 20 ms, with all robots side by side; fields are empty where samples are missing. Units are in the names of the
    columns; docs/how-to/analyse.md lists them. --video shows the models of both robots with the pictures of their eyes, or
    with --eye one eye.
    """
    check_video(video, eye, on)
    recordings, out = sources_and_table(files, film=video is not None)
    if samples and out is None:
        raise typer.BadParameter("--samples needs a table: name a .csv or .parquet file, too.")
    if end is not None and finite(end) < begin:
        raise typer.BadParameter(f"--to {end:g} is before --from {begin:g}: give a later end.")
    for path in (out, video):
        if path is not None:
            check_new(path)
    found = opened(recordings, begin, end, name or ())
    document: dict[str, object] = {"result": True, "robots": robots_of(found)}
    lines = []
    with signals_interrupt():  # so that SIGTERM deletes an incomplete file, as Ctrl-C does
        if out is not None:
            rows = written(out, found, samples=samples)
            document |= {"file": str(out), "rows": rows}
            lines.append(f"{out}: {rows} rows of {', '.join(robots_of(found))}.")
        if video is not None:
            film = written_film(video, recordings, found, eye, on)
            document |= {"video": str(video), "frames": film.frames}
            lines.append(f"{video}: {film.frames} frames, {film.lasts_s:.1f} s of {film.shows}.")
    if found.pauses:
        document["pauses"] = [{"from_s": pause.from_s, "lasts_s": pause.lasts_s} for pause in found.pauses]
        pauses = ", ".join(f"{pause.lasts_s:.1f} s from {pause.from_s:.1f} s on" for pause in found.pauses)
        lines.append(f"Between the files nothing was recorded: {pauses}.")
    if as_json:
        print_json(document)
    else:
        say("\n".join(lines))


def sources_and_table(files: Sequence[Path], *, film: bool) -> tuple[list[Path], Path | None]:
    """Return the recordings and the name of the table among the arguments; raises BadParameter.

    With `film` there may be no table.
    """
    recordings = [path for path in files if path.suffix == RECORDING]
    others = [path for path in files if path.suffix != RECORDING]
    if not recordings:
        raise typer.BadParameter(f"{files[0]} is not the name of a recording: it must end with {RECORDING}.")
    if len({path.resolve() for path in recordings}) < len(recordings):
        raise typer.BadParameter("A recording is given twice: give each file once.")
    if film and not others:
        return recordings, None
    if film_named := [path for path in others if path.suffix.lower() == FILM]:
        raise typer.BadParameter(f"{film_named[0]} is the name of a film: write --video {film_named[0]}.")
    if len(others) != 1 or files[-1] != others[0] or others[0].suffix.lower() not in TABLES:
        given = ", ".join(map(str, others)) or "none is given"
        raise typer.BadParameter(
            f"One table is written, and named last: it must end with {' or '.join(TABLES)} ({given})."
        )
    return recordings, others[0]


def opened(recordings: Sequence[Path], begin: float, end: float | None, names: Sequence[str]) -> Table:
    """Read the files of a recording; raises Refused if one cannot be read, or if Rerun is not installed."""
    from beatrix_zenoh.cli.recording_files import read_recording
    from beatrix_zenoh.recording.export import Span, table

    span = Span(begin) if end is None else Span(begin, end)
    return table([read_recording(path) for path in recordings], span, names)


def written(path: Path, found: Table, *, samples: bool) -> int:
    """Write the table, completely or not at all, and return the number of rows.

    Raises:
        Refused: BAD_VALUE, the part contains no samples, or the file cannot be written.
    """
    from beatrix_zenoh.recording.table_files import write_table

    with new_file(path) as unfinished:
        rows = write_table(unfinished, found.samples() if samples else found.grid())
        if not rows:
            raise Refused(
                Reason.BAD_VALUE,
                f"{path} is not written: no samples are in this part of the recording. Change --from or --to.",
            )
    return rows


def robots_of(found: Table) -> list[str]:
    """Return the robots of a table, for example `bea (sim)`."""
    return [f"{name} ({side})" for name, side in found.robots]
