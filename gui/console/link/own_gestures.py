"""The user's own gestures: read from their folder, and written there."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

from beatrix_zenoh import files
from beatrix_zenoh.client import choreography, motion_file, own_gestures
from beatrix_zenoh.client.shared_gestures import share, shared
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, WrongUsage, wrong_usage
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import WindowError, done, failed
from gui.console.state.actions import NEW, FetchGestures, KeepGesture, Outcome, ShareGesture
from gui.console.state.world import OwnGesture

PERIOD_S: Final = 1.0
"""Period of looking for files that other programs have changed."""
DELETED: Final = "deleted"
"""Folder of gestures that were deleted or replaced; the newest of each name."""


class OwnGestures:
    """Reads the folder again when a file has changed; the methods are called in one thread only."""

    def __init__(self, jobs: Jobs, report: Callable[[Outcome], None], own: tuple[Path, ...] = ()) -> None:
        """Store the arguments; `own`: the folder of a seat, for which those in the folder of the user are common."""
        self._jobs, self._report, self._own = jobs, report, own
        self._due_s = 0.0
        """when to look again (monotonic clock, s); infinite while a look is under way"""
        self._stamps: dict[Path, tuple[int, int]] = {}
        self._found: tuple[OwnGesture, ...] = ()

    def newest(self, now_s: float) -> tuple[OwnGesture, ...]:
        """Return the gestures as read last, and look at the folder again if it is time; returns at once."""
        if now_s >= self._due_s:
            self._due_s = math.inf
            self._jobs.put("gestures", self._read)
        return self._found

    def keep(self, action: KeepGesture) -> None:
        """Write or delete a gesture; returns at once."""
        self._jobs.put("gestures", lambda: self._keep(action))

    def _keep(self, action: KeepGesture) -> None:
        outcome = write(action, *self._own)
        self._read()
        self._report(outcome)

    def exchange(self, action: ShareGesture | FetchGestures, session: Session) -> None:
        """Give a gesture to the class, or get those of the class; returns at once."""
        self._jobs.put("sharing", lambda: self._exchange(action, session))

    def _exchange(self, action: ShareGesture | FetchGestures, session: Session) -> None:
        try:
            if isinstance(action, ShareGesture):
                gesture = read(own_gestures.folder() / f"{action.name}.csv")
                share(session.client, gesture.name, gesture.text)
            else:
                fetch(session)
        except BeatrixError as error:
            self._report(failed(action.row, "", error))
        else:
            self._report(done(action.row, "", "Done."))

    def _read(self) -> None:
        try:
            found: dict[str, Path] = {}
            for folder in (own_gestures.folder(), *self._own):
                paths = sorted(folder.glob("*.csv"), key=_name)[: own_gestures.MOST]
                found |= {_name(path): path for path in paths}  # one of the seat hides a common one
            stats = {path: path.stat() for path in sorted(found.values(), key=_name)}
            stamps = {path: (stat.st_mtime_ns, stat.st_size) for path, stat in stats.items()}
        except OSError:
            stamps = {}
        if stamps != self._stamps:
            self._stamps, self._found = stamps, tuple(self._gesture(path) for path in stamps)
        self._due_s = time.monotonic() + PERIOD_S

    def _gesture(self, path: Path) -> OwnGesture:
        return replace(read(path), common=bool(self._own) and path.parent not in self._own)


def _name(path: Path) -> str:
    return path.name.casefold()


def read(path: Path) -> OwnGesture:
    """Return the gesture of a file; if it cannot be played, with the reason."""
    name, text, wrong = path.stem, "", None
    try:
        text = files.text(path, own_gestures.LARGEST_BYTES, "CSV", path.name)
        choreography.choreography(motion_file.parse(text, path.name))
        wrong = None if own_gestures.possible(name) else wrong_usage(f"{path.name}: {own_gestures.NAMES}")
    except WrongUsage as error:
        wrong = error
    except OSError as error:
        wrong = wrong_usage(f"{path.name} cannot be read: {error.strerror}.")
    return OwnGesture(name, own_gestures.emoji_of(text), text, wrong)


def write(action: KeepGesture, *own: Path) -> Outcome:
    """Write or delete a gesture in the folder `own`, or that of the user, and return the outcome."""
    folder = (*own, own_gestures.folder())[0]
    file, old = folder / f"{action.name}.csv", folder / f"{action.instead}.csv"
    try:
        (folder / DELETED if action.instead else folder).mkdir(parents=True, exist_ok=True)
        if not action.name:
            old.replace(folder / DELETED / old.name)
            return done(action.row, "", f"{old}: deleted.")
        with files.replace_when_complete(file) as unfinished:
            unfinished.write_text(action.text, encoding="utf-8", newline="\n")
            if action.instead and old.exists():
                old.replace(folder / DELETED / old.name)
    except OSError:
        where = str(file if action.name else old)
        return failed(action.row, "", WindowError(Reason.BAD_VALUE, "result.no_write", file=where))
    return done(action.row, "", f"{file}: written.")


def fetch(session: Session) -> None:
    """Write the gestures of the class; one of the user that differs goes to the deleted ones. Raises WindowError."""
    found = shared(session.client)
    if not found:
        raise WindowError(Reason.BAD_VALUE, "result.none_shared")
    for name, text in found.items():
        own = own_gestures.file_of(name)
        if own is None or read(own).text != text:
            outcome = write(KeepGesture(NEW, name, text, "" if own is None else name))
            if not outcome.accepted:
                raise WindowError(outcome.reason, outcome.key, None, **outcome.slots)
