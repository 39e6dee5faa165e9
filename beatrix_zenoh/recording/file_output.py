"""An output that writes rows to a file, or to several files one after the other."""

from __future__ import annotations

import shutil
import time
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.files import check_new
from beatrix_zenoh.recording.about import About
from beatrix_zenoh.recording.output import RobotSet, Say
from beatrix_zenoh.recording.rows import Row
from beatrix_zenoh.recording.rrd.stream import Stream

PERIOD_S: Final = 0.5
"""Period of writing: longer periods make smaller files, but a killed recorder loses up to one period of rows."""
FLUSH_S: Final = 5.0
CLOSE_S: Final = 10.0
SPARE_BYTES: Final = 200_000_000
"""Bytes that the recorder leaves free on the disk, because a full disk stops other programs."""


class FileOutput:
    """A file that is complete after `close`; before that it is readable up to the last half second."""

    def __init__(self, path: Path, say: Say, *, rotate_s: float = 0.0) -> None:
        """Begin the file; with `rotate_s` > 0 begin a new one every `rotate_s` seconds: lesson-001.rrd, lesson-002.rrd.

        Raises:
            Refused: BAD_VALUE, the file exists or cannot be written.
        """
        self._path, self._say, self._rotate_s = path, say, rotate_s
        self._rows: list[Row] = []
        self._robots = RobotSet({})
        self._about: About | None = None
        self.files: list[Path] = []
        """All files of the recording, the newest last."""
        self._number = 0
        self.full = False
        """Whether the disk is too full or too slow; then nothing more is written."""
        self._stream = self._begin()
        self._written_s = self._began_s = time.monotonic()

    @property
    def bytes(self) -> int:
        """Size of all files so far."""
        return sum(path.stat().st_size for path in self.files if path.exists())

    def show(self, robots: RobotSet) -> None:
        """Set the robots of the recording."""
        self._robots = robots
        self._stream.show(robots)

    def describe(self, about: About) -> None:
        """Set what the recording says of itself; each file of it says so."""
        self._about = about
        self._stream.describe(about)

    def write(self, rows: Sequence[Row]) -> None:
        """Keep rows until the next `update`."""
        if not self.full:
            self._rows += rows

    def update(self, now_s: float) -> bool:
        """Write the kept rows if half a second has passed since the last time; return True if a new file has begun."""
        if self.full or now_s < self._written_s + PERIOD_S:
            return False
        self._written_s = now_s
        self._write()
        if self._rotate_s and now_s >= self._began_s + self._rotate_s and not self.full:
            self._stream.close()
            self._stream, self._began_s = self._begin(), now_s
            self._stream.show(self._robots)
            if self._about is not None:
                self._stream.describe(self._about)
            return True
        return False

    def close(self) -> bool:
        """Write the remaining rows and the end of the file; return False if writing fails or takes too long."""
        if not self.full:  # otherwise everything that will be written is, and the user knows
            self._write()
        done = self._stream.flush(CLOSE_S)
        if done:
            self._stream.close()
        return done

    def _write(self) -> None:
        rows, self._rows = self._rows, []
        if rows:
            self._stream.send(rows)
        written = self._stream.flush(FLUSH_S)
        spare = shutil.disk_usage(self.files[-1].parent).free
        if not written or spare < SPARE_BYTES:
            self.full = True
            why = (
                f"{spare / 1e6:.0f} MB are left on this disk"
                if spare < SPARE_BYTES
                else "writing takes too long"
            )
            self._say(f"The recording ends here: {why}. Delete files, or record to another disk.")

    def _begin(self) -> Stream:
        path = self._path
        if self._rotate_s:
            self._number += 1
            # After the first file skip numbers that are taken, so that an earlier recording does not end this one.
            while self.files and numbered(path, self._number).exists():
                self._number += 1
            path = numbered(path, self._number)
        check_new(path)
        stream = Stream(str(uuid.uuid4()), path.stem)
        try:
            stream.to_file(path)
        except OSError as error:
            raise Refused(
                Reason.BAD_VALUE, f"{path} cannot be written: {error.strerror or error}. Name another file."
            ) from error
        self.files.append(path)
        return stream


def numbered(path: Path, number: int) -> Path:
    """Return the path with a number before its suffix, for example `lesson-001.rrd`."""
    return path.with_name(f"{path.stem}-{number:03d}{path.suffix}")
