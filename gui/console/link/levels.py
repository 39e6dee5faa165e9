"""Levels of the microphones of the shown robots: microphones are on only while a client subscribes."""

from __future__ import annotations

import time
from collections import deque
from typing import Final

from beatrix_zenoh.client import Client
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.sound import Microphones, Sound
from gui.console.link.connection import Session
from gui.console.link.pictures import MediaStream
from gui.console.link.worker import Worker

SHOWN: Final = 5
"""Number of blocks (of 20 ms) of which the loudest is shown, so that a clap is seen."""
STALE_S: Final = 0.5
"""Age of the newest block above which there is no level."""

Level = tuple[float, float]
"""Loudness of the left and the right ear (dB): -120 is silence."""


class LevelStream(MediaStream[Sound]):
    """The levels of one robot; keeps no sound."""

    def __init__(self, client: Client, place: Place) -> None:
        """Start the thread, which switches the microphones on."""
        self._client, self._place = client, place
        self._levels: deque[Level] = deque(maxlen=SHOWN)
        self._arrived_s = 0.0
        super().__init__(f"levels-{place[1]}")

    def _subscribe(self) -> Microphones:
        return Microphones(self._client, *self._place, timeout_s=None)

    def _arrived(self, value: Sound) -> None:
        self._levels.append(value.level)
        self._arrived_s = time.monotonic()

    @property
    def level(self) -> Level | None:
        """The loudest of the last blocks; None if no sound arrives."""
        levels = tuple(self._levels)
        if not levels or time.monotonic() - self._arrived_s > STALE_S:
            return None
        return max(left for left, _ in levels), max(right for _, right in levels)


class Levels(Worker):
    """Subscribes to the microphones of wanted sides of the selected robot."""

    def __init__(self) -> None:
        """Start the thread without subscriptions."""
        super().__init__("window-levels")
        self._wanted: frozenset[str] = frozenset()
        self._session: Session | None = None
        self._streams: dict[str, LevelStream] = {}

    def watch(self, wanted: frozenset[str]) -> None:
        """Subscribe to exactly these sides; returns at once."""

        def apply() -> None:
            self._wanted = wanted
            self._apply()

        self.put(apply)

    def follow(self, session: Session) -> None:
        """Subscribe to the microphones of this session's robots from now on; returns at once."""

        def apply() -> None:
            self._end()
            self._session = session
            self._apply()

        self.put(apply)

    @property
    def newest(self) -> dict[str, Level]:
        """The present level of each side from which sound arrives."""
        levels = {side: stream.level for side, stream in dict(self._streams).items()}
        return {side: level for side, level in levels.items() if level is not None}

    def _apply(self) -> None:
        for side in self._streams.keys() - self._wanted:
            self._streams.pop(side).end()
        if self._session is not None:
            for side in self._wanted - self._streams.keys():
                self._streams[side] = LevelStream(self._session.client, (self._session.twin.name, side))

    def _end(self) -> None:
        while self._streams:
            self._streams.popitem()[1].end()

    def close(self) -> None:
        """End the subscriptions and the thread; returns at once."""
        self.put(self._end)
        super().close()
