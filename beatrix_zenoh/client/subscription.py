"""Subscriptions to publications of robots: positions, status, events and pictures."""

from __future__ import annotations

import contextlib
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

import msgspec

from beatrix_zenoh.bus import Bus, ProcessBound, Received
from beatrix_zenoh.client.session import Client, Closable
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, FrameHeader, Positions, Reason, Status
from beatrix_zenoh.contract.errors import NoAnswer, quoted, wrong_usage
from beatrix_zenoh.contract.names import view_title

if TYPE_CHECKING:  # numpy would delay every verb
    import numpy as np
    import numpy.typing as npt

    Pixels = npt.NDArray[np.uint8]

SILENCE_S = 3.0
"""A robot without publications for this long (s) hangs or is lost, because it publishes its status once a second."""
LENGTH = 3000
"""Length of the queue: one minute of positions."""
FIRST_PICTURE_S = 10.0
"""Time limit (s) for the first picture; some cameras take two seconds, a simulation on a busy computer longer."""
PICTURES = 4
"""Queue length for pictures: short, because a slow reader does not need old ones."""
JPEG_BEGIN = b"\xff\xd8"
"""First bytes of every JPEG file."""

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)
M = TypeVar("M", bound=msgspec.Struct)


class Wakeup:
    """Lets one thread wait until another calls `set`; one `set` wakes one thread.

    Ctrl-C inside threading.Condition, on which Event, Future and queue.Queue are built, can leave its lock held: the
    next publication would then block Zenoh's thread for ever. Acquiring and releasing a bare lock is atomic.
    """

    def __init__(self) -> None:
        self._set = threading.Lock()
        self._set.acquire()

    def set(self) -> None:
        """Wake the waiting thread; if none waits, the next `wait_for` returns from its first wait at once."""
        with contextlib.suppress(RuntimeError):  # it was set before
            self._set.release()

    def wait_for(self, condition: Callable[[], object], timeout_s: float | None) -> bool:
        """Wait until `condition()`, checked at each `set`, is true; return False after `timeout_s` (s), if not None."""
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        while not condition():
            left_s = -1.0 if deadline_s is None else deadline_s - time.monotonic()
            if deadline_s is not None and left_s <= 0:
                return False
            self._set.acquire(timeout=min(left_s, threading.TIMEOUT_MAX))
        return True


@dataclass(frozen=True)
class Arrival(Generic[T_co]):
    """A publication and its arrival by the monotonic and wall clock of this computer (ns)."""

    value: T_co
    robot: str
    side: str
    t_mono_ns: int
    t_wall_ns: int


Reader = Callable[[Client, Received], T | None]
"""Converts a publication to the value of a subscription; for an invalid one, logs the error and returns None."""


def message(kind: type[M], convert: Callable[[M], T]) -> Reader[T]:
    """Make a reader for messages of `kind` that applies `convert`."""

    def read(client: Client, received: Received) -> T | None:
        found = client.read(received, kind)
        return None if found is None else convert(found)

    return read


class Subscription(ProcessBound, Closable, Suggesting, Generic[T]):
    """Publications of one key: iterate over them, call `next`, or read `latest`.

        with robot.stream() as readings:
            for reading in readings:
                print(reading.head.yaw)

    Zenoh's thread enqueues publications with their times of arrival, the reading thread decodes them; undecodable ones
    are skipped and logged once. A slow reader loses the oldest: see `dropped`. The iteration ends when the subscription
    or its client is closed.
    """

    def __init__(
        self,
        client: Client,
        key: str,
        read: Reader[T],
        *,
        timeout_s: float | None = None,
        length: int = LENGTH,
        bus: Bus | None = None,
    ) -> None:
        """Subscribe to `key`.

        Args:
            client: the session.
            key: the key of a publication, with the names of one robot or with wildcards.
            read: converts publications to values, for example `message(Status, convert)`.
            timeout_s: longest wait for a publication (s), after which NoAnswer is raised; None: for ever.
            length: length of the queue; older publications are dropped.
            bus: session to use instead of the client's own.

        Raises:
            WrongUsage: the client was closed.
        """
        self._client, self._key, self._timeout_s = client, key, timeout_s
        self._reader = read
        self.dropped: int = 0
        """Number of publications that were dropped because they were not read in time."""
        self._dropped_keys: Counter[str] = Counter()
        self._waiting: deque[Received] = deque(maxlen=length)
        self._wakeup = Wakeup()
        self._closed = False
        self._newest: Received | None = None
        self._latest: tuple[Received, Arrival[T] | None] | None = None
        self._undeclare = (client.bus if bus is None else bus).subscribe(key, self._receive)
        client.at_close(self)

    def _receive(self, received: Received) -> None:
        """Enqueue a publication."""
        if self._closed:
            return
        if len(self._waiting) == self._waiting.maxlen:
            with contextlib.suppress(IndexError):  # a reader may empty the queue at this moment
                self._dropped_keys[self._waiting.popleft().key] += 1
                self.dropped += 1
        self._waiting.append(received)
        self._newest = received
        self._wakeup.set()

    def _next(self, timeout_s: float | None) -> Received | None:
        """Return the oldest publication; None after `timeout_s` (s), or if the queue is closed and empty."""
        self._wakeup.wait_for(lambda: self._waiting or self._closed, timeout_s)
        try:
            received = self._waiting.popleft()
        except IndexError:
            received = None
        if self._waiting or self._closed:
            self._wakeup.set()  # for another thread that waits
        return received

    @property
    def dropped_keys(self) -> Mapping[str, int]:
        """Number of dropped publications by key, for a subscription to many robots."""
        return self._dropped_keys.copy()

    @property
    def latest(self) -> T | None:
        """The newest publication, read or not; None if none has arrived or the newest is unreadable."""
        newest = self._newest
        if newest is None:
            return None
        if self._latest is None or self._latest[0] is not newest:
            self._latest = newest, self._read(newest)
        return None if self._latest[1] is None else self._latest[1].value

    def next(self, timeout_s: float | None = None) -> T:
        """Return the oldest unread publication; wait up to `timeout_s` (s), by default that of the subscription.

        Raises:
            NoAnswer: TIMED_OUT after the time limit, SHUTDOWN if the subscription is closed.
        """
        return self.next_arrival(timeout_s).value

    def next_arrival(self, timeout_s: float | None = None) -> Arrival[T]:
        """Return the publication of `next` with the time of its arrival."""
        timeout_s = self._timeout_s if timeout_s is None else timeout_s
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        while True:
            left = None if deadline is None else max(0.0, deadline - time.monotonic())
            received = self._next(left)
            if received is None:
                raise self._silence(timeout_s or 0.0)
            arrival = self._read(received)
            if arrival is not None:
                return arrival

    def take(self, timeout_s: float = 0.0) -> list[T]:
        """Return all unread publications, oldest first; wait up to `timeout_s` (s) for the first."""
        return [arrival.value for arrival in self.take_arrivals(timeout_s)]

    def take_arrivals(self, timeout_s: float = 0.0) -> list[Arrival[T]]:
        """Return the publications of `take` with the times of their arrival."""
        arrivals = []
        received = self._next(timeout_s)
        while received is not None:
            if (arrival := self._read(received)) is not None:
                arrivals.append(arrival)
            received = self._next(0.0)
        return arrivals

    def arrivals(self) -> Iterator[Arrival[T]]:
        """Yield publications with the times of their arrival; end when the subscription is closed."""
        while True:
            try:
                yield self.next_arrival()
            except NoAnswer as error:
                if error.reason is Reason.SHUTDOWN:
                    return
                raise

    def __iter__(self) -> Iterator[T]:
        return (arrival.value for arrival in self.arrivals())

    def _read(self, received: Received) -> Arrival[T] | None:
        parts = keys.parse(received.key)
        value = None if parts is None else self._reader(self._client, received)
        if parts is None or value is None:
            return None
        return Arrival(value, parts.robot, parts.side, received.t_mono_ns, received.t_wall_ns)

    def _silence(self, timeout_s: float) -> NoAnswer:
        if self._closed:
            return NoAnswer(Reason.SHUTDOWN, f"The subscription to {self._key} was closed by this program.")
        parts = keys.parse(self._key)
        side = "" if parts is None or parts.side == "*" else f" ({parts.side})"
        name = self._key if parts is None else f"{parts.robot}{side}"
        what, cause = "message", "The robot does not respond, or is no longer online."
        if parts is not None and parts.eye:
            what = f"picture from the {view_title(parts.eye)}"
            cause = (
                "The field `cameras` of the robot's status gives the cause; an eye that is not listed there has no "
                "camera."
            )
        elif parts is not None and parts.row == "microphones":
            what = "sound"
            cause = (
                "The field `microphones` of the robot's status gives the cause; if it is missing, the robot has none: "
                "start its node with `beatrix hw --microphones DEVICE`."
            )
        return NoAnswer(Reason.TIMED_OUT, f"{name}: no {what} for {timeout_s:g} s. {cause}")

    def close(self) -> None:
        """End the subscription; a thread that waits for a publication returns. May be called twice."""
        self._undeclare()
        self._closed = True
        self._wakeup.set()


def same(value: T) -> T:
    """Return the message unchanged."""
    return value


def positions(
    client: Client, robot: str = "*", side: str = "*", *, timeout_s: float | None = SILENCE_S
) -> Subscription[Positions]:
    """Subscribe to positions (rad); reading raises NoAnswer if none arrives for `timeout_s` (s), with None never."""
    return Subscription(client, keys.positions(robot, side), message(Positions, same), timeout_s=timeout_s)


def status(
    client: Client, robot: str = "*", side: str = "*", *, timeout_s: float | None = SILENCE_S
) -> Subscription[Status]:
    """Subscribe to status, on change and once a second; see `positions` for arguments and errors."""
    return Subscription(client, keys.status(robot, side), message(Status, same), timeout_s=timeout_s)


def events(
    client: Client, robot: str = "*", side: str = "*", *, timeout_s: float | None = None
) -> Subscription[Event]:
    """Subscribe to events; see `positions` for arguments and errors."""
    return Subscription(client, keys.events(robot, side), message(Event, same), timeout_s=timeout_s)


class CameraImage(FrameHeader, frozen=True, kw_only=True):
    """A picture of one eye, or of a simulated head from outside.

    `seq` counts the pictures of each camera: a gap shows lost ones. `t_mono_ns` and `t_wall_ns` are the clocks of the
    robot at the exposure (ns), `width` and `height` pixels, `source` the origin, for example `opencv` or `pattern`.
    """

    jpeg: bytes
    """the contents of a JPEG file"""
    eye: str
    """`left`, `right` or `outside`"""
    arrived_mono_ns: int
    """monotonic clock of this computer at the arrival (ns)"""
    arrived_wall_ns: int
    """wall clock of this computer at the arrival, ns since 1970"""

    def __str__(self) -> str:
        size = f"{self.width} x {self.height} px, {len(self.jpeg) / 1000:.1f} kB"
        return f"{names.view_title(self.eye)}, picture {self.seq}: {size}, {self.source}"

    def __repr__(self) -> str:
        return f"<{self}>"

    def _repr_jpeg_(self) -> bytes:
        """Return the picture, which a notebook shows."""
        return self.jpeg

    def array(self) -> Pixels:
        """Return the pixels: shape (height, width, 3), red, green, blue from 0 to 255.

        Raises:
            WrongUsage: BAD_VALUE, the package simplejpeg is not installed, or the JPEG data are damaged.
        """
        try:
            import simplejpeg  # noqa: PLC0415 - in the extras `sim` and `hw`
        except ModuleNotFoundError as error:
            text = "array() needs the package simplejpeg, which `beatrix install sim` installs."
            raise wrong_usage(text) from error
        try:
            pixels: Pixels = simplejpeg.decode_jpeg(self.jpeg)
        except ValueError as error:
            text = f"{self}: its JPEG data are damaged ({error}): take the next picture."
            raise wrong_usage(text) from error
        return pixels


def images(
    client: Client,
    robot: str,
    side: str,
    eye: str,
    *,
    timeout_s: float | None,
    length: int = PICTURES,
) -> Subscription[CameraImage]:
    """Subscribe to pictures; `*` stands for all robots or both sides. See `Subscription` for `timeout_s` and `length`.

    Raises:
        WrongUsage: BAD_VALUE: there is no such eye, or hardware has no outside view; SHUTDOWN: the client was closed.
        NoAnswer: NO_ROUTER or ACCOUNT_REFUSED.
    """
    if eye not in names.VIEWS:
        choice = "choose 'left' or 'right', or 'outside' for a simulation as seen from outside"
        raise wrong_usage(f"There is no eye {quoted(eye)}: {choice}.")
    if eye == names.OUTSIDE and side == "hw":
        text = "Only simulations draw an outside view: choose the side 'sim', or the eye 'left' or 'right'."
        raise wrong_usage(text)
    key = keys.camera(robot, side, eye)
    return Subscription(client, key, image, timeout_s=timeout_s, length=length, bus=client.media)


def image(client: Client, received: Received) -> CameraImage | None:
    """Convert a publication to a picture; log a warning and return None if it is not a JPEG with a valid header."""
    parts = keys.parse(received.key)
    if not received.payload.startswith(JPEG_BEGIN):
        client.report(
            received, "ignored: it is not a JPEG picture. Another program publishes on this key: end it."
        )
        return None
    header = client.read(received.header, FrameHeader)
    if parts is None or header is None:
        return None
    return CameraImage(
        jpeg=received.payload,
        eye=parts.eye,
        **msgspec.structs.asdict(header),
        arrived_mono_ns=received.t_mono_ns,
        arrived_wall_ns=received.t_wall_ns,
    )
