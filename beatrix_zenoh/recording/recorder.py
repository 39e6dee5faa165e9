"""The recorder: writes the publications of robots to files, viewers, or both."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Self

from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.recording.about import about
from beatrix_zenoh.recording.losses import Count, Stream
from beatrix_zenoh.recording.notes import NoteInbox
from beatrix_zenoh.recording.output import Output, Say
from beatrix_zenoh.recording.recording_thread import RecordingThread
from beatrix_zenoh.recording.robot_queries import RobotQueries
from beatrix_zenoh.recording.subscriptions import RobotSubscriptions

CAMERAS_HZ = 5.0


class Recorder:
    """Records until it is closed.

        with Client(settings) as client, Recorder(client, [FileOutput(path, print)], print) as recorder:
            shutdown.wait(recorder.check)

    Robots may come and go. Memory is bounded: publications that arrive faster than they are written are dropped, the
    oldest first, and counted. The recorder closes its outputs.
    """

    def __init__(
        self,
        client: Client,
        outputs: Sequence[Output],
        say: Say,
        *,
        names: Sequence[str] = (),
        cameras_hz: float = CAMERAS_HZ,
        title: str = "",
        note: str = "",
        file: Callable[[], str] | None = None,
    ) -> None:
        """Start recording.

        Args:
            client: the session.
            outputs: files and viewers that get the rows.
            say: shows a sentence to the user; called by the recorder's own thread.
            names: names of robots; empty: all robots.
            cameras_hz: pictures per second of each eye; 0: no pictures.
            title: title of the recording; empty: the name of its file.
            note: what the user writes about the recording.
            file: returns the name of the present file; the recorder then takes notes of all seats. None: it takes none.

        Raises:
            WrongUsage: the client was closed.
        """
        self._subscriptions = RobotSubscriptions(client, names, cameras=cameras_hz > 0)
        self._queries = RobotQueries(client)
        facts = about(time.time_ns(), title=title, note=note, seat=client.settings.who)
        self._notes = None if file is None else NoteInbox(client, file, title)
        if self._notes is not None and note:
            self._notes.add(client.settings.who, note)
        self._thread = RecordingThread(
            self._subscriptions, self._queries, outputs, say, cameras_hz, facts, self._notes
        )
        self._closed: bool | None = None

    @property
    def counts(self) -> dict[Stream, Count]:
        """Publications of each stream so far: received, lost on the way, dropped here, late."""
        return self._thread.counts

    @property
    def samples(self) -> int:
        """Number of positions that were recorded so far."""
        return self._thread.samples

    @property
    def robots(self) -> list[Place]:
        """Robots in the recording so far."""
        return self._thread.robots

    def check(self) -> None:
        """Raise the exception that has ended the recorder's thread, if any."""
        if self._thread.failure is not None:
            raise self._thread.failure

    def close(self) -> bool:
        """Write the publications that have arrived, and close all outputs; return False if an output does not close."""
        if self._closed is None:
            if self._notes is not None:
                self._notes.close()
            self._closed = self._thread.close()
            self._subscriptions.close()
            self._queries.close()
        return self._closed

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
