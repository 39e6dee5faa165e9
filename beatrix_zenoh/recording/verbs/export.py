"""`beatrix export`: write a recording as a table, a film, or both, or the sound that one robot has heard."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.contract.names import SIDE_TITLES, SIDES
from beatrix_zenoh.files import check_new, new_file
from beatrix_zenoh.output import print_json, progress_bar, say
from beatrix_zenoh.recording.verbs.files import RECORDING, only, read_recording
from beatrix_zenoh.shutdown import signals_interrupt
from beatrix_zenoh.terminal.options import Json, Names, Which, finite

if TYPE_CHECKING:  # importing numpy and rerun would delay every verb
    from beatrix_zenoh.body.video import FilmFrame
    from beatrix_zenoh.recording.export import Table
    from beatrix_zenoh.recording.samples import EyePicture

WAV = ".wav"
FILM = ".mp4"


class EyeName(StrEnum):
    """An eye: the value of --eye."""

    LEFT = "left"
    RIGHT = "right"


MCAP = ".mcap"
TABLES = (".csv", ".parquet", MCAP)

Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="RECORDING.rrd... [FILE]",
        help="The recording, all its files if it was rotated, then the table: .csv, .parquet or .mcap.",
    ),
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
Wav = Annotated[
    Path | None,
    typer.Option("--sound", metavar="FILE.wav", help="What the microphones of a robot have heard."),
]
On = Annotated[
    Which | None,
    typer.Option("--on", help="With --eye or --sound: of the simulation (sim) or the hardware (hw)."),
]


def export(
    files: Files,
    begin: From = 0.0,
    end: To = None,
    name: Names = None,
    video: Video = None,
    eye: Eye = None,
    sound: Wav = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Write a recording as a table, MCAP, film or sound.

    A row every 20 ms, with all robots side by side; fields are empty where samples are missing. Units are in the names of the
    columns; docs/how-to/analyse.md lists them. MCAP has every sample as a message, in rad. --video shows the models of both robots, or with --eye what one eye saw.
    """
    check_options(video, sound, eye, on)
    recordings, out = sources_and_table(files, alone=video is not None or sound is not None)
    if end is not None and finite(end) < begin:
        raise typer.BadParameter(f"--to {end:g} is before --from {begin:g}: give a later end.")
    for path in filter(None, (out, video, sound)):
        check_new(path)
    found = opened(recordings, begin, end, name or ())
    document: dict[str, object] = {"result": True, "robots": robots_of(found)}
    lines = []
    with signals_interrupt():  # so that SIGTERM deletes an incomplete file, as Ctrl-C does
        if out is not None:
            rows = written(out, found)
            what = "messages" if out.suffix.lower() == MCAP else "rows"
            document |= {"file": str(out), what: rows}
            lines.append(f"{out}: {rows} {what} of {', '.join(robots_of(found))}.")
        if video is not None:
            frames, left_out, shows = written_film(video, recordings, found, eye, on)
            document |= {"video": str(video), "frames": frames, "left_out": left_out}
            without = f" {left_out} damaged or repeated pictures are left out." if left_out else ""
            lines.append(f"{video}: {frames} frames of {shows}.{without}")
        if sound is not None:
            seconds, lost_s = write_sound(sound, recordings, found, on)
            document |= {"sound": str(sound), "seconds": seconds, "lost_s": lost_s}
            lines.append(f"{sound}: {seconds:.1f} s of sound, {lost_s:.2f} s of it missing and silent.")
    if as_json:
        print_json(document)
    else:
        say("\n".join(lines))


def sources_and_table(files: Sequence[Path], *, alone: bool) -> tuple[list[Path], Path | None]:
    """Return the recordings and the name of the table among the arguments; raises BadParameter.

    With `alone`, a film or a sound is written, and there may be no table.
    """
    recordings = [path for path in files if path.suffix == RECORDING]
    others = [path for path in files if path.suffix != RECORDING]
    if not recordings:
        raise typer.BadParameter(f"{files[0]} is not the name of a recording: it must end with {RECORDING}.")
    if alone and not others:
        return recordings, None
    if len(others) != 1 or files[-1] != others[0] or others[0].suffix.lower() not in TABLES:
        given = ", ".join(map(str, others)) or "none is given"
        raise typer.BadParameter(
            f"One table is written, and named last: it must end with {', '.join(TABLES[:-1])} or {MCAP} ({given}). A film is named by "
            "--video FILE.mp4, a sound by --sound FILE.wav."
        )
    return recordings, others[0]


def opened(recordings: Sequence[Path], begin: float, end: float | None, names: Sequence[str]) -> Table:
    """Read the files of a recording; raises Refused if one cannot be read, or if Rerun is not installed."""
    from beatrix_zenoh.recording.export import table

    return table(read_recording(*recordings), begin, math.inf if end is None else end, names)


def written(path: Path, found: Table) -> int:
    """Write the table, completely or not at all, and return the number of rows, or of messages of MCAP.

    Raises:
        Refused: BAD_VALUE, the part contains no samples, or the file cannot be written.
    """
    from beatrix_zenoh.recording.export import write_table

    write = mcap_writer() if path.suffix.lower() == MCAP else lambda out, part: write_table(out, part.grid())
    with new_file(path) as unfinished:
        rows = write(unfinished, found)
        if not rows:
            raise bad_value(
                f"{path} is not written: no samples are in this part of the recording. Change --from or --to.",
            )
    return rows


def mcap_writer() -> Callable[[Path, Table], int]:
    """Return the function that writes MCAP; raises Refused if its library is not installed."""
    try:
        from beatrix_zenoh.recording.mcap import write_mcap
    except ModuleNotFoundError as error:
        raise bad_value(f"A file of MCAP needs {error.name}. Run `beatrix install mcap`.") from error
    return write_mcap


def robots_of(found: Table) -> list[str]:
    """Return the robots of a table, for example `bea (sim)`."""
    return [f"{name} ({side})" for name, side in found.robots]


def check_options(video: Path | None, sound: Path | None, eye: EyeName | None, on: Which | None) -> None:
    """Check the options of films and sounds before anything is read; a path is None if none is asked for.

    Raises:
        BadParameter: wrong options.
        Refused: BAD_VALUE, the library for films is not installed.
    """
    for option, path, ending in (("--video", video, FILM), ("--sound", sound, WAV)):
        if path is not None and path.suffix.lower() != ending:
            raise typer.BadParameter(f"{option} {path}: the name must end in {ending}.")
    if (eye is not None and video is None) or (on is not None and eye is None and sound is None):
        raise typer.BadParameter(
            "--eye needs --video FILE.mp4; --on chooses the robot of --eye or --sound: give --eye left, --eye right or "
            "--sound FILE.wav, too. Without --eye a film shows simulation and hardware."
        )
    if video is None:
        return
    try:
        import beatrix_zenoh.recording.film  # noqa: F401
    except ModuleNotFoundError as error:
        raise bad_value(
            f"--video needs {error.name}. Run `beatrix install video`.",
        ) from error


def written_film(
    path: Path, recordings: Sequence[Path], table: Table, eye: EyeName | None, on: Which | None
) -> tuple[int, int, str]:
    """Write a film of an eye, or of both robots of a name, completely or not at all.

    Returns the number of frames, that of pictures of the eye that are not in it, and a description.

    Raises:
        Refused: BAD_VALUE, the choice is not unique, there are no pictures, or the file cannot be written.
    """
    from beatrix_zenoh.body.video import write_video
    from beatrix_zenoh.recording.film import eye_frames, side_by_side
    from beatrix_zenoh.recording.rrd.read import read_eyes

    sides = dict(sorted(table.robots))
    name, _ = only(sides.items(), None, None, "positions of")
    pictures: Sequence[EyePicture] = ()
    if eye is None:
        titles = [SIDE_TITLES[side] for side in SIDES if (name, side) in table.robots]
        shows, frames = f"{name}, {' and '.join(titles)}", side_by_side(table, name)
    else:
        eyes = read_eyes(recordings, list(table.robots), table.first_ns, table.last_ns)
        seen = [(robot, side) for robot, side, of in eyes if of == eye]
        _, side = only(seen, name, on, f"pictures of the {eye} eye (`record --cameras 5`) of")
        pictures = eyes[name, side, eye]
        shows, frames = f"the {eye} eye of {name} ({side})", eye_frames(pictures)
    with new_file(path) as unfinished:
        count = write_video(unfinished, watched(frames, table))
        if not count:
            raise bad_value(f"{path} is not written: this span contains no whole picture.")
    return count, max(0, len(pictures) - count), shows


def watched(frames: Iterable[FilmFrame], table: Table) -> Iterator[FilmFrame]:
    """Yield frames, and show the progress."""
    lasts_s = (table.last_ns - table.first_ns) / 1e9
    with progress_bar("Writing the film", lasts_s) as bar:
        for frame in frames:
            if bar is not None:
                bar((frame.time_ns - table.first_ns) / 1e9)
            yield frame


def write_sound(
    path: Path, recordings: Sequence[Path], table: Table, on: Which | None
) -> tuple[float, float]:
    """Write what one robot has heard, completely or not at all.

    Raises:
        Refused: BAD_VALUE, the choice is not unique, there is no sound, or the file cannot be written.
    """
    from beatrix_zenoh.recording.rrd.read import read_sound
    from beatrix_zenoh.recording.sound import write_wav

    heard = read_sound(recordings, list(table.robots), table.first_ns, table.last_ns)
    place = only(heard, None, on, "the sound (`record --sound`) of")
    with new_file(path) as unfinished:
        return write_wav(unfinished, heard[place])
