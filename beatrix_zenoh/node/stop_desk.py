"""STOP's own road: however many press it, one request goes to the board, EMERGENCY_STOP before STOP."""

from __future__ import annotations

import threading
from collections.abc import Callable

from beatrix_zenoh import threads
from beatrix_zenoh._generated.serial import FrameType
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.answers import Asker

ORDER = (FrameType.EMERGENCY_STOP, FrameType.STOP)


class StopDesk:
    """A thread that sends what is pressed; `press` only hands over.

    `send(road)` asks the board and may raise BeatrixError; `tell(road, asker, error)` is
    called once with nobody, then for everybody who waits.
    """

    def __init__(
        self,
        send: Callable[[FrameType], None],
        tell: Callable[[FrameType, Asker | None, BeatrixError | None], None],
    ) -> None:
        self._send, self._tell = send, tell
        self._pressed: dict[FrameType, list[Asker]] = {}
        self._news = threading.Condition()
        self._closed = False
        self._thread = threads.start(self._run, "stop")

    def press(self, road: FrameType, asker: Asker | None) -> None:
        """STOP or EMERGENCY_STOP; `asker` is None if nobody waits for an answer.

        Once closed nothing is sent any more: who closes it stops what runs.
        """
        with self._news:
            closed = self._closed
            if not closed:
                waiting = self._pressed.setdefault(road, [])
                if asker is not None:
                    waiting.append(asker)
                self._news.notify()
        if closed:
            self._tell(road, asker, None)

    def _run(self) -> None:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._pressed or self._closed)
                if not self._pressed:
                    return
                road = next(road for road in ORDER if road in self._pressed)
                waiting = self._pressed.pop(road)
            failure = None
            try:
                self._send(road)
            except BeatrixError as error:
                failure = error
            self._tell(road, None, failure)
            for asker in waiting:
                self._tell(road, asker, failure)

    def close(self) -> None:
        """Send what was pressed, then end."""
        with self._news:
            self._closed = True
            self._news.notify()
        self._thread.join(timeout=2.0)
