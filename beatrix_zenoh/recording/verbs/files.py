"""Read and repair recordings (.rrd)."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract.errors import Refused, bad_value
from beatrix_zenoh.output import note, print_json, say, typed
from beatrix_zenoh.recording.viewer import check_exists, complete, program, repair, verify

if TYPE_CHECKING:  # importing numpy would delay every verb
    from beatrix_zenoh.recording.samples import Recorded

RECORDING = ".rrd"
DAMAGED = ".damaged"
EMPTY = "it contains no positions of a robot. The file is unchanged: record again."


def read_recording(*paths: Path) -> Recorded:
    """Read the files of a recording; raises Refused if one cannot be read, or if Rerun is not installed."""
    try:
        from beatrix_zenoh.recording.rrd.read import read
    except ModuleNotFoundError as error:
        raise bad_value(
            f"Reading a recording needs {error.name}. Run `beatrix install rerun`.",
        ) from error
    found = read(*paths)
    for path in paths:
        note_if_incomplete(path)
    return found


def only(candidates: Iterable[Place], name: str | None, side: str | None, what: str) -> Place:
    """Return the only robot of this name and side; None: any. Raises Refused unless there is exactly one.

    Args:
        candidates: name and side of the robots that have what is asked for.
        name: of the robot.
        side: `sim`, `hw` or `both`, which chooses none.
        what: of what there has to be one, as in: "the sound of"
    """
    held = sorted(candidates)
    chosen = [place for place in held if name in (None, place[0]) and side in (None, "both", place[1])]
    if len(chosen) == 1:
        return chosen[0]
    listed = ", ".join(f"{robot} ({side})" for robot, side in held) or "no robot"
    raise bad_value(
        f"This part of the recording has {what} {listed}: choose one robot with --name, and --on sim or --on hw where it has both.",
    )


def describe(path: Path) -> None:
    """Print what a recording says of itself; nothing for a file of an earlier version or a damaged one."""
    from beatrix_zenoh.recording.rrd.read import read_about

    with contextlib.suppress(Refused):
        about = read_about(path)
        for text in about.lines() if about is not None else ():
            note(text)


def note_if_incomplete(path: Path) -> None:
    """Print a note if the end of a recording is missing, because the last data may be missing, too."""
    if not complete(path):
        note(
            f"The end of {path} is missing: its recorder is still running, or was killed. "
            f"If it was killed, complete the file: `{typed('beatrix', 'record', '--repair', path)}`."
        )


def repair_recording(path: Path, *, as_json: bool) -> None:
    """Complete a recording whose end is missing; the damaged file is kept beside it.

    Raises:
        WrongUsage: there is no such file.
        Refused: BAD_VALUE, it contains no readable positions, is not of BEATRIX, or Rerun is not installed.
    """
    program()  # raises before any file is changed
    from beatrix_zenoh.recording.rrd.read import read

    check_exists(path)
    if not verify(path):
        read(path)
        if as_json:
            print_json({"result": True, "file": str(path), "damaged": None})
        else:
            say(f"{path} is complete: there is nothing to repair.")
        return
    unfinished, kept = path.with_suffix(f".repaired{RECORDING}"), path.with_name(path.name + DAMAGED)
    try:
        if why := repair(path, unfinished):
            raise bad_value(f"{path} cannot be repaired: {why}")
        try:
            read(unfinished)
        except Refused as error:
            raise bad_value(f"{path} cannot be repaired: {EMPTY}") from error
        path.replace(kept)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
    if as_json:
        print_json({"result": True, "file": str(path), "damaged": str(kept)})
    else:
        say(f"{path} is repaired. The damaged file is kept as {kept}; you can delete it.")
