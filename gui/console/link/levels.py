"""Levels of the microphones of the shown robots: microphones are on only while a client subscribes."""

from __future__ import annotations

import time
from collections import deque
from typing import Final

from beatrix_zenoh.client import Client
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.sound import Microphones, Sound
from gui.console.link.jobs import Jobs
from gui.console.link.pictures import MediaStream, Watcher

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


class Levels(Watcher[str, LevelStream]):
    """Subscribes to the microphones of wanted sides of the selected robot."""

    def __init__(self, jobs: Jobs) -> None:
        """Subscribe to nothing yet."""
        super().__init__("levels", jobs, lambda client, robot, side: LevelStream(client, (robot, side)))

    @property
    def newest(self) -> dict[str, Level]:
        """The present level of each side from which sound arrives."""
        streams = {} if self.streams is None else dict(self.streams.open)
        levels = {side: stream.level for side, stream in streams.items()}
        return {side: level for side, level in levels.items() if level is not None}
