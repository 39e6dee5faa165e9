"""Films of recordings, for `beatrix export --video`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from beatrix_zenoh.cli.options import Which
from beatrix_zenoh.cli.progress import progress_bar
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import SIDE_TITLES, SIDES
from beatrix_zenoh.files import new_file

if TYPE_CHECKING:  # importing numpy, rerun and av would delay every verb
    from beatrix_zenoh.recording.export import Table
    from beatrix_zenoh.recording.film import EyePictures, Frame

FILM = ".mp4"
OF_ONE_EYE = "with what the eyes saw (--eye left or --eye right: a film of one eye alone)"
NO_PICTURES = "without pictures of the eyes, which were not recorded (`beatrix record --cameras 5`)"


class EyeName(StrEnum):
    """An eye: the value of --eye."""

    LEFT = "left"
    RIGHT = "right"


class Film(NamedTuple):
    """A film that was written: number of frames, length, and a description."""

    frames: int
    lasts_s: float
    shows: str


def check_video(path: Path | None, eye: EyeName | None, on: Which | None) -> None:
    """Check the options of a film before anything is read; the path is None if none is asked for.

    Raises:
        BadParameter: wrong options.
        Refused: BAD_VALUE, the library for films is not installed.
    """
    if path is None:
        if eye is not None or on is not None:
            raise typer.BadParameter(
                "--eye and --on choose the pictures of a film: give --video FILE.mp4, too."
            )
        return
    if path.suffix.lower() != FILM:
        raise typer.BadParameter(f"--video {path}: the name must end in {FILM}.")
    if on is not None and eye is None:
        raise typer.BadParameter(
            "--on chooses the robot of an eye: give --eye left or --eye right, too. Without --eye the film shows "
            "simulation and hardware."
        )
    if on is Which.BOTH:
        raise typer.BadParameter(
            "--on both: a film shows an eye of one robot. Give sim or hw; without --eye both robots are beside each other."
        )
    try:
        import beatrix_zenoh.recording.video  # noqa: F401
    except ModuleNotFoundError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f'--video needs {error.name}. Run `pip install ".[video]"` in the folder of BEATRIX.',
        ) from error


def written_film(
    path: Path, recordings: Sequence[Path], table: Table, eye: EyeName | None, on: Which | None
) -> Film:
    """Write a film of an eye, or of both robots of a name, completely or not at all.

    Raises:
        Refused: BAD_VALUE, the choice is not unique, there are no pictures, or the file cannot be written.
    """
    from beatrix_zenoh.recording.film import side_by_side
    from beatrix_zenoh.recording.rrd.eyes import read_eyes
    from beatrix_zenoh.recording.video import write_video

    name = only_name(table)
    eyes = read_eyes(recordings, list(table.robots), table.first_ns, table.last_ns)
    times: list[int] = []
    if eye is None:
        sides = [SIDE_TITLES[side] for side in SIDES if (name, side) in table.robots]
        pictures = OF_ONE_EYE if any(robot == name for robot, _, _ in eyes) else NO_PICTURES
        shows, frames = f"{name}, {' and '.join(sides)}, {pictures}", side_by_side(table, name, eyes)
    else:
        shows, frames = of_eye(eyes, name, eye, on)
    with new_file(path) as unfinished:
        count = write_video(unfinished, watched(frames, times, table))
        if not count:
            raise Refused(Reason.BAD_VALUE, f"{path} is not written: this span contains no whole picture.")
    return Film(count, (times[-1] - times[0]) / 1e9, shows)


def only_name(table: Table) -> str:
    """Return the only name of the robots in a table; raises Refused if there are several."""
    names = sorted({name for name, _ in table.robots})
    if len(names) > 1:
        raise Refused(
            Reason.BAD_VALUE,
            f"The recording contains {', '.join(names)}: choose the robot of the film with --name.",
        )
    return names[0]


def of_eye(eyes: EyePictures, name: str, eye: EyeName, on: Which | None) -> tuple[str, Iterator[Frame]]:
    """Return a description and the frames of an eye; raises Refused unless exactly one robot has pictures of it."""
    from beatrix_zenoh.recording.film import eye_frames

    sides = [side for robot, side, of in eyes if (robot, of) == (name, eye) and on in (None, side)]
    if len(sides) > 1:
        raise Refused(
            Reason.BAD_VALUE, f"Both robots have pictures of the {eye} eye: choose --on sim or --on hw."
        )
    if not sides:
        held = ", ".join(f"{of} ({robot}, {side})" for robot, side, of in sorted(eyes)) or "none"
        raise Refused(
            Reason.BAD_VALUE,
            f"This part of the recording has no such pictures of the {eye} eye; it has pictures of: {held}. "
            "Choose another eye, robot or part; `beatrix record --cameras 5` records pictures.",
        )
    return f"the {eye} eye of {name} ({sides[0]})", eye_frames(eyes[name, sides[0], eye])


def watched(frames: Iterable[Frame], times: list[int], table: Table) -> Iterator[Frame]:
    """Yield frames, add their times to a list, and show the progress."""
    lasts_s = (table.last_ns - table.first_ns) / 1e9
    with progress_bar("Writing the film", lasts_s) as bar:
        for frame in frames:
            times.append(frame.time_ns)
            if bar is not None:
                bar((frame.time_ns - table.first_ns) / 1e9)
            yield frame
