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
from beatrix_zenoh.contract._generated.messages import Reason
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
CLOSE_S: Final = 1.0
"""Longest time that `Streams.close` takes."""
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
        self._thread = threads.start(self._run, name)

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._deliver()
            except (NoAnswer, WrongUsage) as error:
                if error.reason is Reason.SHUTDOWN:
                    return
                if isinstance(error, WrongUsage):
                    raise
                self._ended.wait(RETRY_S)

    def _deliver(self) -> None:
        """Deliver publications until the subscription ends; raises NoAnswer if no router answers."""
        subscription = self._subscribe()
        with self._lock:
            self._subscription = subscription
            if self._ended.is_set():  # `end` was called too early to close it
                subscription.close()
        while True:
            value = subscription.next()
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

    def join(self, timeout_s: float) -> None:
        """Wait for the end of the thread, at most `timeout_s` (s)."""
        self._thread.join(max(0.0, timeout_s))


Stream = TypeVar("Stream", bound=MediaStream[Any])


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


class Streams(Generic[Key, Stream]):
    """Exactly the wanted streams; only one thread may call the methods."""

    def __init__(self, begin: Callable[[Key], Stream]) -> None:
        """Create the object without streams; `begin` starts one."""
        self._begin = begin
        self.open: dict[Key, Stream] = {}

    def watch(self, wanted: frozenset[Key]) -> None:
        """Subscribe to exactly these streams; does not wait for router or robot.

        Absent robots and cameras are included as soon as they appear. After the return nothing else is delivered.
        """
        for key in self.open.keys() - wanted:
            self.open.pop(key).end()
        for key in wanted - self.open.keys():
            self.open[key] = self._begin(key)

    def close(self) -> None:
        """End all subscriptions within 1 s; nothing is delivered after the return."""
        streams = list(self.open.values())
        self.watch(frozenset())
        deadline_s = time.monotonic() + CLOSE_S
        for stream in streams:
            stream.join(deadline_s - time.monotonic())


class Watcher(Generic[Key, Stream]):
    """Subscribes to wanted streams when there is a session, and again when another robot is selected."""

    def __init__(self, name: str, jobs: Jobs, begin: Callable[[Client, str, Key], Stream]) -> None:
        """Subscribe to nothing yet, in the queue `name` of the jobs; `begin` starts a stream of the robot of a name."""
        self._name, self._jobs, self._begin = name, jobs, begin
        self._wanted: frozenset[Key] = frozenset()
        self.streams: Streams[Key, Stream] | None = None

    def watch(self, wanted: frozenset[Key]) -> None:
        """Subscribe to exactly these streams; returns at once."""

        def apply() -> None:
            self._wanted = wanted
            if self.streams is not None:
                self.streams.watch(wanted)

        self._jobs.put(self._name, apply)

    def follow(self, session: Session) -> None:
        """Subscribe to the streams of this session's robots from now on; returns at once."""

        def apply() -> None:
            self._end()
            robot = session.twin.name
            self.streams = Streams(lambda key: self._begin(session.client, robot, key))
            self.streams.watch(self._wanted)

        self._jobs.put(self._name, apply)

    def _end(self) -> None:
        if self.streams is not None:
            self.streams.close()
            self.streams = None

    def close(self) -> None:
        """End the subscriptions; returns at once."""
        self._jobs.put(self._name, self._end)


def cameras(jobs: Jobs, on_image: OnImage) -> Watcher[Camera, CameraStream]:
    """Return what subscribes to cameras; `on_image` receives side and picture on its threads, and must return at once."""

    def begin(client: Client, robot: str, camera: Camera) -> CameraStream:
        return CameraStream(client, (robot, *camera), on_image)

    return Watcher("cameras", jobs, begin)


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
