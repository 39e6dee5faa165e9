"""The sound of `beatrix export`: a WAV file of what one robot has heard."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.files import new_file
from beatrix_zenoh.terminal.options import Which

if TYPE_CHECKING:  # importing numpy and rerun would delay every verb
    from beatrix_zenoh.recording.export import Table
    from beatrix_zenoh.recording.sound import WrittenSound

WAV = ".wav"


def check_sound(path: Path | None) -> None:
    """Check the name of a sound, None if none is asked for; raises BadParameter."""
    if path is not None and path.suffix.lower() != WAV:
        raise typer.BadParameter(f"--sound {path}: the name must end in {WAV}.")


def write_sound(path: Path, recordings: Sequence[Path], table: Table, on: Which | None) -> WrittenSound:
    """Write what one robot has heard, completely or not at all.

    Raises:
        Refused: BAD_VALUE, the choice is not unique, there is no sound, or the file cannot be written.
    """
    from beatrix_zenoh.recording.rrd.read import read_sound
    from beatrix_zenoh.recording.sound import write_wav

    robots = [(name, side) for name, side in table.robots if on in (None, Which.BOTH, side)]
    heard = read_sound(recordings, robots, table.first_ns, table.last_ns)
    if not heard:
        raise Refused(
            Reason.BAD_VALUE,
            "This part of the recording has no such sound. `beatrix record --sound` records the microphones.",
        )
    if len(heard) > 1:
        found = ", ".join(f"{name} ({side})" for name, side in sorted(heard))
        raise Refused(
            Reason.BAD_VALUE,
            f"The recording has the sound of {found}: choose one with --name, and --on sim or --on hw.",
        )
    ((_, blocks),) = heard.items()
    with new_file(path) as unfinished:
        return write_wav(unfinished, blocks)
