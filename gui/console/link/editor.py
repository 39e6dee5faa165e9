"""The program in the code panel, and its file."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Final

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state.actions import EXAMPLES, OpenProgram, WriteProgram
from gui.console.state.world import CodeProgress, Trouble

LOOK_S: Final = 0.5
"""Period of looking whether another program has changed the file."""
LARGEST_BYTES: Final = 1 << 19
"""Largest size of a program to open."""


class Editor:
    """Writes what the user types, and reads the file again if another program has changed it.

    One thread uses it, for a window Qt's.
    """

    def __init__(self) -> None:
        """Begin with the program of the presses."""
        self._now = CodeProgress(Path.home() / "beatrix-programs/presses.py")
        self._looked_s = 0.0
        self._stamp: files.Stamp | None = None
        """of the file when it was read or written last"""

    def progress(self, now_s: float) -> CodeProgress:
        """Return the program at a time (monotonic clock, s)."""
        file = self._now.file
        if file is not None and now_s - self._looked_s > LOOK_S:
            self._looked_s = now_s
            if files.stamp(file) not in (self._stamp, None):
                self._read(file)
        return self._now

    def open(self, action: OpenProgram) -> None:
        """Read another program, or go back to that of the presses."""
        self._now = replace(self._now, opens=self._now.opens + 1)
        if action.file is None:
            self._now = CodeProgress(self._now.presses, opens=self._now.opens)
        else:
            self._read(action.file)

    def _read(self, file: Path) -> None:
        stamp = files.stamp(file)
        try:
            text = files.text(file, LARGEST_BYTES, "Python")
        except (OSError, WrongUsage):
            # The program that is shown stays.
            self._now = replace(self._now, trouble=Trouble("result.no_program", slots={"file": str(file)}))
        else:
            self._stamp = stamp
            self._now = replace(self._now, file=file, text=text, trouble=None)

    def write(self, action: WriteProgram) -> None:
        """Write the program; the file of a shipped one, or of the presses, becomes one of the user's with a new name."""
        presses, trouble = self._now.presses, None
        file = action.file or self._now.file or presses
        if not file.suffix:  # a folder for a new program
            file = unused(file / "program.py")
        if file != presses or action.file is None:
            if file == presses or file.is_relative_to(EXAMPLES.parent):
                file = unused(presses.with_name("program.py" if file == presses else file.name))
            self._now = replace(self._now, file=file, text=action.text)
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            with files.replace_when_complete(file) as unfinished:
                unfinished.write_text(action.text, encoding="utf-8")
        except OSError:
            trouble = Trouble("result.no_write", slots={"file": str(file)})
        self._now, self._stamp = replace(self._now, trouble=trouble), files.stamp(file)


def unused(file: Path) -> Path:
    """Return the file with the first number at its name that no other file has."""
    names = (file.with_name(f"{file.stem}-{number}.py") for number in itertools.count(1))
    return next(name for name in names if not name.exists())
