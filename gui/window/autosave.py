"""Saves the choices and poses of a window in the user's file when they change."""

from __future__ import annotations

import logging

from gui.console.state import saved
from gui.console.state.saved import Saved
from gui.console.state.state import State

logger = logging.getLogger("beatrix.window")


class Autosave:
    """Writes the changes of this window, and keeps those that other windows have saved in the meantime."""

    def __init__(self, state: State) -> None:
        """Treat the present choices as already saved."""
        self._state, self._file = state, saved.path()
        self._kept: Saved = state.saved

    def save_changes(self) -> None:
        """Write the changes since the last call, if any; log a failure, which must not end the window."""
        mine = self._state.saved
        if mine == self._kept:
            return
        before, self._kept = self._kept, mine
        try:
            theirs, _ = saved.load(self._file)
            saved.save(self._file, saved.merged(before, mine, theirs))
        except OSError as error:
            logger.warning("The choices of the window cannot be saved: %s.", error)
