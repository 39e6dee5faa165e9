"""The outputs of a recorder: files, one after the other, and a viewer, which may start, end and stop responding at any time."""

from __future__ import annotations

import shutil
import time
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from beatrix_zenoh import memory, threads
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.files import check_new
from beatrix_zenoh.recording.rows import RecordingRow, RobotSet, Say, SoundRow
from beatrix_zenoh.recording.rrd.stream import Batch, RowStream
from beatrix_zenoh.recording.samples import About
from beatrix_zenoh.recording.viewer import HOST, PORT, address, answers

PERIOD_S: Final = 0.5
"""Period of checking what is due, and the disk."""
DUE_SHARE: Final = 0.1
DUE_S: Final = 60.0
"""Rows are due when they are older than this share of the file's length, at most DUE_S.

A killed recorder loses the rows that are not due yet. But each chunk takes 0.3 kB of the file beside its rows, and 1 kB
of memory until the file is complete, because Rerun keeps a table of all chunks for the end of the file.
"""
CHUNK_BYTES: Final = 4_000_000
"""Pictures and sound of this size are due at once."""
FLUSH_S: Final = 5.0
CLOSE_S: Final = 10.0
SPARE_BYTES: Final = 200_000_000
"""Bytes that the recorder leaves free on the disk, because a full disk stops other programs."""


class FileOutput:
    """A file that is complete after `close`; before that it lacks the rows that are not due."""

    def __init__(self, path: Path, say: Say, *, rotate_s: float = 0.0) -> None:
        """Begin the file; with `rotate_s` > 0 begin a new one every `rotate_s` seconds: lesson-001.rrd, lesson-002.rrd.

        Raises:
            Refused: BAD_VALUE, the file exists or cannot be written.
        """
        self._path, self._say, self._rotate_s = path, say, rotate_s
        self._batches: dict[str, Batch] = {}
        self.files: list[Path] = []
        """All files of the recording, the newest last."""
        self._number = 0
        self.full = False
        """Whether the disk is too full or too slow; then nothing more is written."""
        self._stream = self._begin()
        self._checked_s = self._written_s = self._began_s = time.monotonic()

    @property
    def bytes(self) -> int:
        """Size of all files so far."""
        return sum(path.stat().st_size for path in self.files if path.exists())

    def show(self, robots: RobotSet) -> None:
        """Set the robots of the recording."""
        self._stream.show(robots)

    def describe(self, about: About) -> None:
        """Set what the recording says of itself."""
        self._stream.describe(about)

    def write(self, rows: Sequence[RecordingRow]) -> None:
        """Keep rows until they are due."""
        if not self.full:
            for row in rows:
                self._batches.setdefault(row.path, Batch()).add(row)

    def update(self, now_s: float) -> bool:
        """Write the rows that are due; return True if a new file has begun."""
        if self.full or now_s < self._checked_s + PERIOD_S:
            return False
        self._checked_s, lasted_s = now_s, now_s - self._began_s
        ends = self._rotate_s > 0 and lasted_s >= self._rotate_s
        everything = ends or now_s >= self._written_s + min(DUE_S, lasted_s * DUE_SHARE)
        if everything:
            self._written_s = now_s
        self._write(everything=everything)
        if ends and not self.full:
            self._stream.close()
            self._stream, self._began_s = self._begin(), now_s
            return True
        return False

    def close(self) -> bool:
        """Write the remaining rows and the end of the file; return False if writing fails or takes too long."""
        if not self.full:  # otherwise everything that will be written is, and the user knows
            self._write(everything=True)
        done = self._stream.flush(CLOSE_S)
        if done:
            self._stream.close()
        return done

    def _write(self, *, everything: bool) -> None:
        written = self._send(everything=everything) and self._stream.flush(FLUSH_S)
        spare = shutil.disk_usage(self.files[-1].parent).free
        if not written or spare < SPARE_BYTES:
            self.full = True
            self._send(everything=True)
            why = (
                f"{spare / 1e6:.0f} MB are left on this disk"
                if spare < SPARE_BYTES
                else "writing takes too long"
            )
            self._say(f"The recording ends here: {why}. Delete files, or record to another disk.")

    def _send(self, *, everything: bool) -> bool:
        """Send what is due, one batch after the other: what waits to be written takes memory for the rest of the time."""
        due = [path for path, batch in self._batches.items() if everything or batch.bytes >= CHUNK_BYTES]
        written = True
        for path in due:
            self._stream.send_batches({path: self._batches.pop(path)})
            written = written and self._stream.flush(FLUSH_S)
        if everything:
            memory.give_back()  # otherwise 4 MB more in an hour
        return written

    def _begin(self) -> RowStream:
        path = self._path
        if self._rotate_s:
            self._number += 1
            # After the first file skip numbers that are taken, so that an earlier recording does not end this one.
            while self.files and numbered(path, self._number).exists():
                self._number += 1
            path = numbered(path, self._number)
        check_new(path)
        stream = RowStream(str(uuid.uuid4()), path.stem)
        try:
            stream.to_file(path)
        except OSError as error:
            raise bad_value(
                f"{path} cannot be written: {error.strerror or error}. Name another file."
            ) from error
        self.files.append(path)
        return stream


def numbered(path: Path, number: int) -> Path:
    """Return the path with a number before its suffix, for example `lesson-001.rrd`."""
    return path.with_name(f"{path.stem}-{number:03d}{path.suffix}")


SENDING_S: Final = 0.1
PROBE_S: Final = 1.0
RECEIVING_S: Final = 0.5
THAWING_S: Final = 0.02
"""Used instead of RECEIVING_S while the viewer does not respond, so that files do not wait for it."""
LEAVING_S: Final = 2.0


class LiveOutput:
    """Sends rows to the viewer on a port of this computer while the viewer receives them.

    For a viewer that does not respond, Rerun keeps up to 200 MB and then blocks; to a viewer that starts after the
    stream it sends nothing. So this class tries the port first, and checks once a second with a time-limited flush
    whether data arrive. `update` reports a viewer that was restarted, which needs the robots again; rows that a viewer
    missed are counted, not sent again.
    """

    def __init__(self, port: int, say: Say) -> None:
        self._port, self._say = port, say
        self._id = str(uuid.uuid4())
        self._rows: list[RecordingRow] = []
        self._stream: RowStream | None = None
        self.connected: bool | None = None
        """Whether a viewer receives data; None: not probed yet."""
        self.left_out = 0
        """Number of rows that the viewer missed."""
        self._sent_s = self._probed_s = 0.0  # the first update probes at once

    def show(self, robots: RobotSet) -> None:
        """Set the robots of the recording, if the viewer receives data."""
        if self._stream is not None and self.connected:
            self._stream.show(robots)

    def describe(self, about: About) -> None:
        """Set what the recording says of itself, if the viewer receives data."""
        if self._stream is not None and self.connected:
            self._stream.describe(about)

    def write(self, rows: Sequence[RecordingRow]) -> None:
        """Keep rows until the next `update`; without a viewer only count them."""
        if self.connected:
            # The viewer draws the waveform and plays no sound, which would only fill its memory.
            self._rows += [row for row in rows if not isinstance(row, SoundRow)]
        else:
            self.left_out += len(rows)

    def update(self, now_s: float) -> bool:
        """Send the kept rows if 0.1 s have passed since the last time, and probe the viewer if 1 s has passed.

        Returns True if the viewer receives data again, or for the first time.
        """
        if self.connected and now_s >= self._sent_s + SENDING_S:
            self._sent_s = now_s
            self._send()
        if now_s < self._probed_s + PROBE_S:
            return False
        self._probed_s = now_s
        before, self.connected = self.connected, self._probe()
        if not self.connected:
            self.left_out += len(self._rows)
            self._rows.clear()
            if before is not False:
                self._say(
                    f"No viewer on {HOST}:{self._port} takes data; they are left out until one responds. Start one with "
                    f"`beatrix view{'' if self._port == PORT else f' --port {self._port}'}`; the robots then appear in it."
                )
        elif before is False:
            self._say(f"The viewer receives data again; it missed {self.left_out} rows.")
        return self.connected and not before

    def close(self) -> bool:
        """Send the remaining rows and disconnect; return False if the viewer blocks either.

        The process must then exit without waiting for Rerun.
        """
        if self.connected:
            self._send()
        if self._stream is None:
            return True
        if not self._stream.flush(LEAVING_S) and not self._stream.broken:
            return False
        # Limit the time: if the viewer has just stopped responding, data in its socket buffer block the disconnect.
        closing = threads.start(self._stream.close, "disconnect-viewer")
        closing.join(LEAVING_S)
        return not closing.is_alive()

    def _send(self) -> None:
        rows, self._rows = self._rows, []
        if rows and self._stream is not None:
            self._stream.send(rows)

    def _probe(self) -> bool:
        """Try the port and the stream; connect to a viewer that has started. Return whether it receives data."""
        listening = answers(self._port)
        patience_s = RECEIVING_S if self.connected or self._stream is None else THAWING_S
        if self._stream is None:
            if not listening:
                return False
            self._stream = RowStream(self._id, "live")
            self._stream.to_viewer(address(self._port))
        if self._stream.flush(patience_s):
            return listening
        if self._stream.broken:
            self._stream.close()
            self._stream = None
        return False


Output = FileOutput | LiveOutput
