"""Photos and films of the robots: their poses, collected while a film runs, and the process that draws them."""

from __future__ import annotations

import math
import subprocess
import threading
import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh.client.degrees import reading
from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.processes import PYTHON, open_in_browser
from gui.console.link.children import folder
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs
from gui.console.state.actions import TakePicture
from gui.console.state.world import PictureProgress, Trouble

PERIOD_S: Final = 0.04
"""Time between two poses of a film; see `gui.console.shots.RATE`."""
FILM_S, LONGEST_S = 10.0, 60.0
"""A film ends after FILM_S unless the robots move, and after LONGEST_S in any case."""
STILL: Final = 25
"""Number of equal poses after which a robot does not move."""
WRITE_S: Final = 300.0
"""Time limit of the process that draws: 60 s of both robots take it 80 s."""
LAST: Final = 400
"""Length of the end of an error message (bytes)."""
Pose = tuple[float, ...]


class Filming:
    """Takes one photo or film after the other; methods return at once. One thread calls them, for a window Qt's."""

    def __init__(self, jobs: Jobs, session: Callable[[], Session | None]) -> None:
        self._jobs, self._session = jobs, session
        self._began_s = math.inf
        """when the film began (monotonic clock, s); infinite: none runs"""
        self._end, self._writing, self._closed = threading.Event(), False, False
        self._process: subprocess.Popen[bytes] | None = None
        self._file: Path | None = None
        self._trouble: Trouble | None = None

    def progress(self) -> PictureProgress:
        """Return whether a film runs or is being written, and the newest file."""
        began_s = self._began_s  # read once: another thread ends the film
        seconds = None if math.isinf(began_s) else time.monotonic() - began_s
        return PictureProgress(seconds, self._writing, self._file, self._trouble)

    def take(self, action: TakePicture) -> None:
        """Take a photo or begin a film, unless one is under way."""
        session = self._session()
        if session is None or self._writing or not math.isinf(self._began_s):
            return
        self._end.clear()
        self._trouble = None
        if action.film:
            self._began_s = time.monotonic()
        self._jobs.put("pictures", lambda: self._take(action, session))

    def end(self) -> None:
        """End the film; its file is complete once `progress` returns it."""
        self._end.set()

    def _take(self, action: TakePicture, session: Session) -> None:
        monitor, robot = session.monitor, session.twin.name
        moments: list[tuple[Pose, ...]] = []
        while action.film or not moments:
            found = tuple(pose(monitor.positions(robot, side)) for side in action.sides)
            if not all(found):
                break
            moments.append(found)
            if ended(moments) or self._end.is_set():
                break
            due_s = self._began_s + len(moments) * PERIOD_S
            self._end.wait(max(0.0, due_s - time.monotonic()) if action.film else 0.0)
        self._writing, self._began_s = True, math.inf
        try:
            if not self._closed:
                self._write(action, robot, moments)
        except OSError as error:  # no process can be started
            self._trouble = Trouble("trouble.picture", detail=str(error))
        finally:
            self._writing = False

    def _write(self, action: TakePicture, robot: str, moments: list[tuple[Pose, ...]]) -> None:
        now = datetime.now().astimezone()
        name = folder("pictures") / f"{robot}-{now:%Y-%m-%d-%H%M%S}"
        texts = {"caption": action.caption, "date": f"{now:%Y-%m-%d}", "titles": action.titles}
        shot = {**texts, "poses": moments}
        command, pipe = [*PYTHON, "gui.console.shots", str(name)], subprocess.PIPE
        with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe) as process:
            self._process = process
            late = threading.Timer(WRITE_S, process.terminate)
            late.start()
            output, errors = process.communicate(msgspec.json.encode(shot))
            late.cancel()
        if process.returncode:
            self._trouble = Trouble("trouble.picture", detail=errors.decode(errors="replace")[-LAST:])
        else:
            self._file = Path(output.decode().strip())

    def open(self, file: Path) -> None:
        """Open a picture in the user's browser or viewer, which stays open after the window."""

        def show() -> None:
            if not open_in_browser(file.as_uri()):
                self._trouble = Trouble("trouble.no_viewer", slots={"file": str(file)})

        self._jobs.put("viewer", show)

    def close(self) -> None:
        """End the film, and drop what is not written."""
        self._closed = True
        self._end.set()
        if self._process is not None:
            self._process.terminate()


def pose(found: Positions | None) -> Pose:
    """Return a pose to a hundredth of a degree, as a Shot has it; empty: it is unknown."""
    seen = None if found is None else reading(found)
    return () if seen is None else tuple(round(angle, 2) for angle in (*seen.arms, *seen.head))


def ended(moments: list[tuple[Pose, ...]]) -> bool:
    """Return whether a film is long enough: FILM_S, or longer while robots move."""
    seconds = len(moments) * PERIOD_S
    return seconds >= LONGEST_S or (seconds >= FILM_S and len({*moments[-STILL:]}) == 1)
