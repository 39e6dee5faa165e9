"""Publish what a sensor delivers while a client subscribes, and report the state of the sensor in the status.

`Sensor` is a thread that reads a device only while a client subscribes, and survives its failures.

A component that makes pictures (the renderer of a simulation, or the thread of a USB camera) has a publisher for each
camera; microphones, with a `sound_block` in place of a picture, and every other sensor use one in the same way:

    self._wake = threading.Event()
    self._left = camera_publisher(key, events, "egl", self._wake.set)
    ...
    def start(self, sessions):      self._left.start(sessions)
    def contribute(self, status):   self._left.contribute(status)
    ...
    while not self._closed:         # in the component's own thread
        if not self._left.subscribed:
            self._wake.wait()       # until a client subscribes
            self._wake.clear()
            continue
        self._left.publish(picture(jpeg, 640, 480, t_mono_ns, "egl"))
"""

from __future__ import annotations

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from msgspec import Struct
from msgspec.structs import replace

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Publication, Sessions
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated.messages import (
    CameraStatus,
    EventKind,
    FrameHeader,
    MicrophonesStatus,
    Reason,
    SoundHeader,
)
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node.events import NodeEvents, new_event
from beatrix_zenoh.node.interfaces import Component, StatusFields

JPEG: Final = "image/jpeg"
WINDOW_S: Final = 2.0
"""Time over which the picture rate is measured."""
PCM: Final = "audio/pcm"
RATE: Final = 48_000
"""Frames per second; a frame has one sample of each ear."""
BLOCK: Final = 960
"""Frames in a block."""
BLOCK_NS: Final = BLOCK * 1_000_000_000 // RATE
FULL_SCALE: Final = 32768
TITLE: Final = "microphones"
SWITCHED: Final = ("The microphones are off.", "The microphones are on: a client listens.")
BEHIND: Final = 5
"""Blocks by which a source may be late; of more the oldest are dropped, so that no burst of old sound follows."""
_SEQS: Final = 2**32

Samples = npt.NDArray[np.floating]
"""Sound pressure, shape (frames, 2), left first; -1 to 1 is what 16 bits can hold."""


class SensorFrame(NamedTuple):
    """What a sensor delivers: a picture or a block of sound, and its header, which `SensorPublisher` numbers."""

    payload: bytes
    header: FrameHeader | SoundHeader


def picture(jpeg: bytes, width: int, height: int, t_mono_ns: int, source: str) -> SensorFrame:
    """Return a picture of this size (pixels).

    `t_mono_ns`: monotonic clock of this computer at the exposure, or at the time of the rendered state. `source`:
    `opencv`, `pattern`, `file`, `egl` or `osmesa`.
    """
    header = FrameHeader(seq=0, t_mono_ns=t_mono_ns, t_wall_ns=0, width=width, height=height, source=source)
    return SensorFrame(jpeg, header)


def sound_block(samples: bytes, t_mono_ns: int, source: str, dropped: int = 0) -> SensorFrame:
    """Return a block of sound: BLOCK frames of two int16, little-endian, left first.

    `t_mono_ns`: monotonic clock of this computer at the first frame. `source`: `device`, `file`, `tone` or
    `simulation`. `dropped`: frames that were lost before they reached the node, since the source was made.
    """
    header = SoundHeader(
        seq=0, t_mono_ns=t_mono_ns, t_wall_ns=0, rate=RATE, dropped=dropped % _SEQS, source=source
    )
    return SensorFrame(samples, header)


def to_pcm(samples: Samples) -> bytes:
    """Return samples as 16-bit integers; what is louder than full scale is cut off, as in a real converter."""
    scaled = samples * FULL_SCALE
    np.rint(scaled, out=scaled)
    np.clip(scaled, -FULL_SCALE, FULL_SCALE - 1, out=scaled)
    return scaled.astype("<i2", order="C").tobytes()


@dataclass(frozen=True)
class SensorKind:
    """What a publisher has to know about a sensor."""

    title: str
    """the sensor in warnings"""
    field: str
    """field of Status with its state"""
    event: EventKind
    encoding: str
    name: str = ""
    """which of several sensors it is; the field is then a list"""
    switched: tuple[str, str] | None = None
    """events that record that a client has switched the sensor off or on; None: no such events"""


class SensorPublisher:
    """Publishes the frames of one sensor; one thread may publish, any thread may read the status."""

    def __init__(
        self,
        key: str,
        events: NodeEvents,
        kind: SensorKind,
        state: Struct,
        on_subscribed: Callable[[], None] = lambda: None,
    ) -> None:
        """Store the arguments; `start` declares the publication.

        Args:
            key: key of the publication.
            events: the events of the node.
            kind: what the sensor is.
            state: state of the sensor before its first frame: a message with `connected`, `streaming` and `trouble`.
                Fields that the headers of its frames have, too, follow them.
            on_subscribed: called when `subscribed` may have changed; may run on Zenoh's thread, must return at once.
        """
        self._key, self._events, self._kind, self.on_subscribed = key, events, kind, on_subscribed
        self._publication: Publication | None = None
        self._lock = threading.Lock()
        self._times_s: deque[float] = deque()
        self._seq = 0
        self._on = False
        self._state, self._trouble = state, ""

    def start(self, sessions: Sessions) -> None:
        """Declare the publication."""
        self._publication = sessions.publication(self._key, self._kind.encoding, self.on_subscribed)

    @property
    def subscribed(self) -> bool:
        """Whether a client subscribes; measure only while this is True."""
        return self._publication is not None and self._publication.subscribed

    def publish(self, frame: SensorFrame, /) -> None:
        """Publish a frame, and report that the sensor works."""
        if self._publication is None:
            return
        self._seq = (self._seq + 1) % _SEQS
        t_wall_ns = frame.header.t_mono_ns + time.time_ns() - time.monotonic_ns()
        header = replace(frame.header, seq=self._seq, t_wall_ns=t_wall_ns)
        self.report("")
        self._switch(on=True)
        now_s = time.monotonic()
        with self._lock:
            self._times_s.append(now_s)
            self._forget(now_s)
            shared = {*header.__struct_fields__}.intersection(self._state.__struct_fields__)
            self._state = replace(self._state, **{name: getattr(header, name) for name in shared})
        # Publish last, so that a client that has the frame reads a status that includes it.
        self._publication.put(frame.payload, codec.encode(header))

    def ended(self) -> None:
        """Report that the sensor is off; the sensor calls it when no client subscribes any more."""
        self._switch(on=False)

    def _switch(self, *, on: bool) -> None:
        with self._lock:
            changed, self._on = on != self._on, on
        if changed and self._kind.switched is not None:
            action = self._kind.name or ("on" if on else "off")
            self._events.add(new_event(kind=self._kind.event, action=action, message=self._kind.switched[on]))

    def report(self, trouble: str) -> None:
        """Set the fault of the sensor, and record a change as an event.

        `trouble`: a sentence with the cause and what to do; empty if the sensor works.
        """
        with self._lock:
            before, self._trouble = self._trouble, trouble
            self._state = replace(self._state, connected=not trouble, trouble=trouble)
        if trouble == before:
            return
        reason, kind = Reason.FAULT if trouble else Reason.OK, self._kind
        text = f"{kind.title}: {trouble or 'connected again.'}"
        self._events.add(new_event(kind=kind.event, action=kind.name, reason=reason, message=text))

    def state(self) -> Struct:
        """Return the present state of the sensor."""
        subscribed = self.subscribed
        with self._lock:
            self._forget(time.monotonic())
            times_s, state = self._times_s, self._state
            span_s = times_s[-1] - times_s[0] if times_s else 0.0
            rate = (len(times_s) - 1) / span_s if subscribed and span_s else 0.0
            # Microphones are on until their device is closed, which may be later than the last client leaves.
            streaming = self._on if self._kind.switched else subscribed and bool(times_s)
        found = {"hz": rate} if "hz" in state.__struct_fields__ else {}
        return replace(state, streaming=streaming, **found)

    def contribute(self, status: StatusFields) -> None:
        """Add the state of the sensor to a status, and its fault as a warning."""
        if self._kind.name:
            status.lists[self._kind.field].append(self.state())
        else:
            status.values[self._kind.field] = self.state()
        if trouble := self._trouble:
            status.warnings.append(f"{self._kind.title}: {trouble}")

    def _forget(self, now_s: float) -> None:
        while self._times_s and now_s - self._times_s[0] > WINDOW_S:
            self._times_s.popleft()


def camera_publisher(
    key: str, events: NodeEvents, source: str, on_subscribed: Callable[[], None] = lambda: None
) -> SensorPublisher:
    """Return the publisher of a camera; the key ends with `left` or `right`, of simulations also with `outside`."""
    eye = key.rpartition("/")[2]
    kind = SensorKind(names.view_title(eye), "cameras", EventKind.CAMERA, JPEG, eye)
    state = CameraStatus(eye=eye, connected=False, streaming=False, hz=0.0, width=0, height=0, source=source)
    return SensorPublisher(key, events, kind, state, on_subscribed)


def microphones_publisher(key: str, events: NodeEvents, source: str, *, announce: bool) -> SensorPublisher:
    """Return the publisher of both microphones; `announce`: an event says when real ones are switched on and off."""
    kind = SensorKind(TITLE, TITLE, EventKind.MICROPHONES, PCM, switched=SWITCHED if announce else None)
    state = MicrophonesStatus(connected=False, streaming=False, rate=RATE, source=source)
    return SensorPublisher(key, events, kind, state)


CHECK_S: Final = 1.0
"""Period of the check whether a device that is not in use is present."""
WAIT_S: Final = 0.2
"""Longest wait for a frame before the thread checks whether a client still subscribes."""
SILENT_S: Final = 3.0
"""Longest time without a frame; some cameras need two seconds for the first one."""

log = logging.getLogger(__name__)


class SensorSource(ABC):
    """A camera, two microphones, what stands in for them, or simulated ones; used by one thread.

    `open` and `next` raise NoAnswer, with a message that says what to do, if there are no frames.
    """

    name: str
    """Kind of source, as in the status."""

    def trouble(self) -> str:
        """Return why there can be no frame now, empty if no reason is known; quick, and does not open the source."""
        return ""

    @abstractmethod
    def open(self) -> None:
        """Start taking frames."""

    @abstractmethod
    def next(self, timeout_s: float) -> SensorFrame | None:
        """Wait for the next frame and return it; None if none arrives within `timeout_s`."""

    def close(self) -> None:  # noqa: B027 - most sources have nothing to free
        """Stop taking frames; may be called twice, and after `open` has failed."""


class TimedSound(SensorSource):
    """A source that makes blocks at exactly 50 a second, and counts the frames that were dropped after delays."""

    def __init__(self) -> None:
        self._next_ns = self._dropped = 0

    def open(self) -> None:
        """Begin the first block now."""
        self._next_ns = time.monotonic_ns()

    def next(self, timeout_s: float) -> SensorFrame | None:
        """Wait until the next block is complete and return it; None if that is only after `timeout_s`."""
        left_s = (self._next_ns + BLOCK_NS - time.monotonic_ns()) / 1e9
        time.sleep(max(0.0, min(left_s, timeout_s)))
        if left_s > timeout_s:
            return None
        late = (time.monotonic_ns() - self._next_ns) // BLOCK_NS - 1
        if late > BEHIND:
            self._dropped += late * BLOCK
            self._next_ns += late * BLOCK_NS
        begin_ns, self._next_ns = self._next_ns, self._next_ns + BLOCK_NS
        return sound_block(self.pcm(begin_ns), begin_ns, self.name, self._dropped)

    @abstractmethod
    def pcm(self, begin_ns: int) -> bytes:
        """Return the frames of the block that began at this monotonic time (ns), as `sound_block` has them."""


class Sensor(Component):
    """Publishes the frames of a source; its failures do not affect the rest of the node."""

    def __init__(
        self,
        title: str,
        source: SensorSource,
        publisher: SensorPublisher,
        silence: str,
        check_s: float | None = CHECK_S,
    ) -> None:
        """Store the arguments; `start` starts the thread.

        Args:
            title: the sensor in the log.
            source: where the frames come from.
            publisher: publishes them.
            silence: a sentence for a device that is present and delivers nothing for SILENT_S.
            check_s: period of the check of a source that is not in use; None: it is always present.
        """
        self._title, self._source, self._publisher = title, source, publisher
        self._silence, self._check_s = silence, check_s
        self._wake = threading.Event()
        publisher.on_subscribed = self._wake.set
        self._failed = ""
        """the last unexpected error"""
        self._closed = False
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        self._publisher.start(sessions)
        self._thread = threads.start(self._run, f"sensor-{self._title}")

    def contribute(self, status: StatusFields) -> None:
        self._publisher.contribute(status)

    def _run(self) -> None:
        """Publish frames until the sensor is closed."""
        seen: str | None = None
        while not self._closed:
            trouble = self._source.trouble()
            # Report only changes: this check does not find problems with taking frames, and must not end the report
            # of such a problem before a frame arrives.
            if trouble != seen:
                self._publisher.report(trouble)
            seen = trouble
            wanted = not trouble and self._publisher.subscribed
            if wanted and self._take():
                continue
            self._wake.wait(CHECK_S if wanted else self._check_s)
            self._wake.clear()

    def _take(self) -> bool:
        """Publish frames while a client subscribes; if the device fails, report that and return False."""
        try:
            try:
                self._source.open()
                self._publish()
            finally:
                self._source.close()
                self._publisher.ended()
        except NoAnswer as error:
            self._publisher.report(error.message)
        except Exception as error:  # a bug here or in a library must not end the node
            if repr(error) != self._failed:  # one traceback, not one a second
                log.exception("%s: failed.", self._title)
            self._failed = repr(error)
            self._publisher.report(f"The device failed: {error}. The node retries every second.")
        else:
            return True
        return False

    def _publish(self) -> None:
        silent_since_s = time.monotonic()
        while self._publisher.subscribed and not self._closed:
            frame = self._source.next(WAIT_S)
            if frame is not None:
                self._publisher.publish(frame)
                silent_since_s = time.monotonic()
            elif time.monotonic() - silent_since_s > SILENT_S:
                raise NoAnswer(Reason.TIMED_OUT, self._silence)

    def close(self) -> None:
        """End the thread."""
        self._closed = True
        self._wake.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
