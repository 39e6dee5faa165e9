"""The user's own gestures: read from their folder, and written there."""

from __future__ import annotations

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
from gui.console.link.jobs import Jobs, Repeated
from gui.console.link.outcomes import WindowError, done, failed
from gui.console.state.actions import NEW, FetchGestures, KeepGesture, Outcome, ShareGesture
from gui.console.state.own_gestures import TAKEN
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
        self._reads = Repeated(jobs, "gestures", PERIOD_S)
        self._stamps: dict[Path, files.Stamp | None] = {}
        self._found: tuple[OwnGesture, ...] = ()

    def newest(self, now_s: float) -> tuple[OwnGesture, ...]:
        """Return the gestures as read last, and look at the folder again if it is time; returns at once."""
        self._reads.look(now_s, self._read)
        return self._found

    def keep(self, action: KeepGesture) -> None:
        """Write or delete a gesture; returns at once."""
        self._jobs.put("gestures", lambda: self._keep(action))

    def _keep(self, action: KeepGesture) -> None:
        self._carry_out(action.row, lambda: write(action, *self._own))
        self._read()

    def exchange(self, action: ShareGesture | FetchGestures, session: Session) -> None:
        """Give a gesture to the class, or get those of the class; returns at once."""
        self._jobs.put("sharing", lambda: self._carry_out(action.row, lambda: exchange(action, session)))

    def _carry_out(self, row: int, do: Callable[[], None]) -> None:
        try:
            do()
        except BeatrixError as error:
            self._report(failed(row, "", error))
        else:
            self._report(done(row, "", "Done."))

    def _read(self) -> None:
        found: dict[str, Path] = {}
        for folder in (own_gestures.folder(), *self._own):
            paths = sorted(folder.glob("[!.]*.csv"), key=_name)[: own_gestures.MOST]
            found |= {_name(path): path for path in paths}  # one of the seat hides a common one
        stamps = {path: files.stamp(path) for path in sorted(found.values(), key=_name)}
        if stamps != self._stamps:
            self._stamps, self._found = stamps, tuple(self._gesture(path) for path in stamps)

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
        if not own_gestures.possible(name):
            wrong = wrong_usage(f"{path.name}: {own_gestures.NAMES}")
        elif name.casefold() in TAKEN:
            wrong = wrong_usage(
                f"{path.name}: {name} is a shipped gesture, which is played instead. Rename the file."
            )
    except WrongUsage as error:
        wrong = error
    except OSError as error:
        wrong = wrong_usage(f"{path.name} cannot be read: {error.strerror}.")
    return OwnGesture(name, own_gestures.emoji_of(text), text, wrong)


def write(action: KeepGesture, *own: Path) -> None:
    """Write or delete a gesture in the folder `own`, or that of the user; what it replaces goes to the deleted ones.

    Raises WindowError.
    """
    folder = (*own, own_gestures.folder())[0]
    file, old = folder / f"{action.name}.csv", folder / f"{action.instead}.csv"
    try:
        (folder / DELETED).mkdir(parents=True, exist_ok=True)
        if not action.name:
            old.replace(folder / DELETED / old.name)
            return
        with files.replace_when_complete(file) as unfinished:
            unfinished.write_text(action.text, encoding="utf-8", newline="\n")
            for gone in filter(Path.exists, (file, old)):
                gone.replace(folder / DELETED / gone.name)
    except OSError as error:
        where = str(file if action.name else old)
        raise WindowError(Reason.BAD_VALUE, "result.no_write", file=where) from error


def exchange(action: ShareGesture | FetchGestures, session: Session) -> None:
    """Give a gesture to the class, or write those of the class.

    Raises:
        BeatrixError: the class has none, a file cannot be written, or as `share` and `shared`.
    """
    if isinstance(action, ShareGesture):
        given = read(own_gestures.folder() / f"{action.name}.csv")
        if given.wrong is not None:
            raise given.wrong
        share(session.client, action.name, given.text)
        return
    found = shared(session.client)
    if not found:
        raise WindowError(Reason.BAD_VALUE, "result.none_shared")
    for name, text in found.items():
        own = own_gestures.file_of(name)
        if own is None or read(own).text != text:
            write(KeepGesture(NEW, name, text))
