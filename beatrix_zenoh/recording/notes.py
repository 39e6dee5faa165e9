"""Notes that users put into a running recording."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.bus.query_forms import read
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import NoteQuery, NoteReply, Reason
from beatrix_zenoh.contract.codec import encode_json
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.recording.rows import MARK, NOTES, Bar, Line, RecordingRow, clock
from beatrix_zenoh.recording.samples import Note

WAITING: Final = 10
"""Notes that may arrive between two steps of the recorder; more are refused, so that a program cannot flood a recording."""
CLOSED: Final = "The recording ends: it takes no more notes."


class Arrived(NamedTuple):
    """A note, and its arrival by the monotonic clock of this computer."""

    seat: str
    text: str
    t_mono_ns: int


class NoteInbox:
    """Takes the notes of all seats while it is open."""

    def __init__(self, client: Client, file: Callable[[], str], title: str) -> None:
        """Answer queries for notes; `file` returns the name of the present file."""
        self._file, self._title = file, printable.label(title)
        self._session = client.bus.session_id
        self._waiting: deque[Arrived] = deque()
        self._closed = False
        client.bus.serve(keys.note("*", self._session), self._receive)

    def take(self) -> list[Arrived]:
        """Return the notes since the last call."""
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

    def close(self) -> None:
        """Refuse further notes."""
        self._closed = True

    def add(self, seat: str, text: str) -> None:
        """Add a note; raises Refused for one that cannot be taken."""
        if not seat:
            raise Refused(
                Reason.BAD_VALUE, f"A note needs one seat in its key, for example {keys.note('ana', '*')}."
            )
        line = printable.line(text).strip()
        if not line:
            raise Refused(Reason.BAD_VALUE, "The note is empty: give its text.")
        if self._closed:
            raise Refused(Reason.SHUTDOWN, CLOSED)
        if len(self._waiting) >= WAITING:
            raise Refused(Reason.BUSY, "Too many notes arrive at once. Send this one again.")
        self._waiting.append(Arrived(seat, line, time.monotonic_ns()))

    def _receive(self, incoming: Incoming) -> None:
        """Answer on Zenoh's thread."""
        parts = keys.parse(incoming.key)
        raw, seat = incoming.raw, "" if parts is None else parts.who
        try:
            self.add(seat, read(raw, NoteQuery).text)
            reason, text = Reason.OK, ""
        except BeatrixError as error:
            reason, text = error.reason, error.message
        reply = NoteReply(
            result=reason is Reason.OK,
            reason=reason,
            message=text,
            file=printable.label(self._file()),
            title=self._title,
            t_wall_ns=time.time_ns(),
        )
        if seat:
            incoming.reply(keys.note(seat, self._session), *raw.answer(reply))
        else:
            incoming.reply_error(*raw.answer(reply))
        incoming.finish()


def rows_of(note: Note) -> Iterator[RecordingRow]:
    """Yield a line of the log, and a mark on the time line that lasts until the next note."""
    text = f"{clock(note.time_ns)}  note by {note.seat}:  {note.text}"
    yield Line(NOTES, note.time_ns, note.time_ns, text, "INFO", encode_json(note).decode())
    yield Bar(MARK, note.time_ns, note.time_ns, note.text)
