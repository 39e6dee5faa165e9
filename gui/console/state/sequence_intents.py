"""Intents of the sequence editor. A pose is named by its name, which is unique."""

from __future__ import annotations

from pathlib import Path

from gui.console.state.intents import Intent


class AddPose(Intent, frozen=True):
    """Add the target of the pad, or the present pose, at the end."""


class MovePose(Intent, frozen=True):
    """Move a pose to another place of the sequence."""

    name: str
    to: int
    """number of the place, from 0, counted without the pose"""


class DuplicatePose(Intent, frozen=True):
    """Insert a copy after a pose: a pause of that duration, until one of them is changed."""

    name: str


class SetDuration(Intent, frozen=True):
    """Choose the time in which a pose is reached from the previous one."""

    name: str
    seconds: float


class RenamePose(Intent, frozen=True):
    """Give a pose another name."""

    name: str
    new: str


class UndoSequence(Intent, frozen=True):
    """Undo the last change of the poses, for example a deletion."""


class PlaySequence(Intent, frozen=True):
    """Play the sequence on one robot; on the hardware only after the simulation has played it."""

    side: str
    """`sim` or `hw`"""


class SaveSequence(Intent, frozen=True):
    """Write the sequence as a choreography, or as a program."""

    file: Path
    program: bool = False


class OpenSequence(Intent, frozen=True):
    """Replace the sequence by the choreography in a file."""

    file: Path
    text: str
    trouble: str = ""
    """why the file cannot be read; empty: `text` is its content"""
