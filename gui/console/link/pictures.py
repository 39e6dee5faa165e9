"""Subscriptions to exactly the visible pictures and levels: cameras and microphones are on only while a client subscribes."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final, Generic, TypeVar

from beatrix_zenoh import threads
from beatrix_zenoh.client import CameraImage, Client
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.sound import Microphones, Sound
from beatrix_zenoh.client.subscription import Subscription, images
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs

OnImage = Callable[[str, CameraImage], None]
"""Twin and picture."""
Camera = tuple[str, str]
"""Twin and eye."""
Key = TypeVar("Key")
Media = TypeVar("Media")
RETRY_S: Final = 1.0
"""Time between attempts to open the session for media while no router answers."""
SHOWN: Final = 5
"""Number of blocks (of 20 ms) of which the loudest is shown, so that a clap is seen."""
STALE_S: Final = 0.5
"""Age of the newest block above which there is no level."""

Level = tuple[float, float]
"""Loudness of the left and the right ear (dB): -120 is silence."""


class MediaStream(Generic[Media]):
    """What one camera or one robot's microphones publish, read by a thread of its own."""

    def __init__(
        self, name: str, subscribe: Callable[[], Subscription[Media]], arrived: Callable[[Media], None]
    ) -> None:
        """Start the thread, which has this name.

        Args:
            name: of the thread.
            subscribe: returns a new subscription; raises NoAnswer if no router answers.
            arrived: takes each publication; must return at once.
        """
        self._subscribe, self._arrived = subscribe, arrived
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._subscription: Subscription[Media] | None = None
        threads.start(self._run, name)

    def _run(self) -> None:
        """Deliver publications until `end`, or until the client is closed."""
        while not self._ended.is_set():
            try:
                subscription = self._subscribe()
            except NoAnswer:
                self._ended.wait(RETRY_S)
                continue
            except WrongUsage:
                return  # the client was closed
            with self._lock:
                self._subscription = subscription
                if self._ended.is_set():  # `end` was called too early to close it
                    subscription.close()
            for value in subscription:
                with self._lock:
                    if not self._ended.is_set():
                        self._arrived(value)

    def end(self) -> None:
        """End the subscription; nothing is delivered after the return."""
        with self._lock:
            self._ended.set()
            subscription = self._subscription
        if subscription is not None:
            subscription.close()


class CameraStream(MediaStream[CameraImage]):
    """Pictures of one camera; only the newest is kept."""

    def __init__(self, client: Client, camera: tuple[str, str, str], on_image: OnImage) -> None:
        """Start the thread; `camera` is robot, side and eye."""
        _, side, eye = camera
        super().__init__(
            f"pictures-{side}-{eye}",
            lambda: images(client, *camera, timeout_s=None, length=1),
            lambda image: on_image(side, image),
        )


class LevelStream(MediaStream[Sound]):
    """The levels of one robot; keeps no sound."""

    def __init__(self, client: Client, place: Place) -> None:
        """Start the thread, which switches the microphones on."""
        self._levels: deque[Level] = deque(maxlen=SHOWN)
        self._arrived_s = 0.0
        super().__init__(
            f"levels-{place[1]}", lambda: Microphones(client, *place, timeout_s=None), self._heard
        )

    def _heard(self, sound: Sound) -> None:
        self._levels.append(sound.level)
        self._arrived_s = time.monotonic()

    @property
    def level(self) -> Level | None:
        """The loudest of the last blocks; None if no sound arrives."""
        levels = tuple(self._levels)
        if not levels or time.monotonic() - self._arrived_s > STALE_S:
            return None
        return max(left for left, _ in levels), max(right for _, right in levels)


Stream = TypeVar("Stream", bound=MediaStream[Any])


class Watcher(Generic[Key, Stream]):
    """Subscribes to exactly the wanted streams while there is a session."""

    def __init__(
        self,
        name: str,
        jobs: Jobs,
        session: Callable[[], Session | None],
        begin: Callable[[Session, Key], Stream],
    ) -> None:
        """Subscribe to nothing yet.

        Args:
            name: queue of the jobs that begin and end streams.
            jobs: the executor.
            session: returns the present session.
            begin: starts a stream of a session.
        """
        self._name, self._jobs, self._session, self._begin = name, jobs, session, begin
        self._wanted: frozenset[Key] = frozenset()
        self.open: dict[Key, Stream] = {}

    def watch(self, wanted: frozenset[Key]) -> None:
        """Subscribe to exactly these streams, those of absent robots as soon as they appear; returns at once."""
        self._wanted = wanted
        self._jobs.put(self._name, lambda: self._apply(wanted))

    def restart(self) -> None:
        """Subscribe anew to all streams, because there is another session; returns at once."""
        if self._wanted:
            self._jobs.put(self._name, lambda: self._apply(frozenset()))
            self.watch(self._wanted)

    def close(self) -> None:
        """End all subscriptions; returns at once."""
        self.watch(frozenset())

    def _apply(self, wanted: frozenset[Key]) -> None:
        for key in self.open.keys() - wanted:
            self.open.pop(key).end()
        session = self._session()
        if session is not None:
            self.open |= {key: self._begin(session, key) for key in wanted - self.open.keys()}


def levels(streams: dict[Key, LevelStream]) -> dict[Key, Level]:
    """Return the present level of each robot from which sound arrives."""
    found = {key: stream.level for key, stream in streams.copy().items()}
    return {key: level for key, level in found.items() if level is not None}
