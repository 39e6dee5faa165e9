"""Publish pictures and sound while a client subscribes, and report the state of cameras and microphones in the status.

A component that makes pictures (the renderer of a simulation, or the thread of a USB camera) has a `CameraPublisher`
for each camera; with a `SoundBlock` in place of a picture, a `MicrophonesPublisher` is used in the same way:

    self._wake = threading.Event()
    self._left = CameraPublisher(key, events, "egl", self._wake.set)
    ...
    def start(self, sessions):      self._left.start(sessions)
    def contribute(self, status):   self._left.contribute(status)
    ...
    while not self._closed:         # in the component's own thread
        if not self._left.subscribed:
            self._wake.wait()       # until a client subscribes
            self._wake.clear()
            continue
        self._left.publish(CameraFrame(jpeg, 640, 480, t_mono_ns, "egl"))
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import msgspec
import numpy as np
import numpy.typing as npt

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
from beatrix_zenoh.node.events import NodeEvents
from beatrix_zenoh.node.interfaces import StatusFields

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
BEHIND: Final = 5
"""Blocks by which a source may be late; of more the oldest are dropped, so that no burst of old sound follows."""
_SEQS: Final = 2**32

Samples = npt.NDArray[np.floating]
"""Sound pressure, shape (frames, 2), left first; -1 to 1 is what 16 bits can hold."""


@dataclass(frozen=True)
class SoundBlock:
    """A block of sound."""

    samples: bytes
    """BLOCK frames of two int16, little-endian, left first"""
    t_mono_ns: int
    """monotonic clock of this computer at the first frame"""
    source: str
    """`device`, `file`, `tone` or `simulation`"""
    dropped: int = 0
    """frames that were lost before they reached the node, since the source was made"""


def to_pcm(samples: Samples) -> bytes:
    """Return samples as 16-bit integers; what is louder than full scale is cut off, as in a real converter."""
    scaled = samples * FULL_SCALE
    np.rint(scaled, out=scaled)
    np.clip(scaled, -FULL_SCALE, FULL_SCALE - 1, out=scaled)
    return scaled.astype("<i2", order="C").tobytes()


class BlockClock:
    """The times of blocks at exactly 50 a second, and the number of frames that were dropped after delays."""

    def __init__(self) -> None:
        self.dropped = 0
        self._next_ns = 0

    def restart(self) -> None:
        """Begin the first block now."""
        self._next_ns = time.monotonic_ns()

    def wait(self, timeout_s: float) -> int | None:
        """Wait until the next block is complete; return the monotonic time (ns) of its first frame.

        None if it is complete only after `timeout_s`.
        """
        left_s = (self._next_ns + BLOCK_NS - time.monotonic_ns()) / 1e9
        if left_s > timeout_s:
            time.sleep(timeout_s)
            return None
        if left_s > 0:
            time.sleep(left_s)
        late = (time.monotonic_ns() - self._next_ns) // BLOCK_NS - 1
        if late > BEHIND:
            self.dropped += late * BLOCK
            self._next_ns += late * BLOCK_NS
        begin_ns = self._next_ns
        self._next_ns += BLOCK_NS
        return begin_ns


class MicrophonesPublisher:
    """Publishes the sound of both microphones; one thread may publish, any thread may read the status."""

    def __init__(
        self, key: str, events: NodeEvents, source: str, on_subscribed: Callable[[], None], *, announce: bool
    ) -> None:
        """Store the arguments; `start` declares the publication.

        Args:
            key: key of the publication.
            events: the events of the node.
            source: source of the sound, as in `SoundBlock`.
            on_subscribed: called when `subscribed` may have changed; may run on Zenoh's thread, must return at once.
            announce: record an event when the microphones are switched on and off, as real ones must.
        """
        self._key, self._events, self._on_subscribed = key, events, on_subscribed
        self._announce = announce
        self._publication: Publication | None = None
        self._lock = threading.Lock()
        self._seq = 0
        self._on = False
        self._status = MicrophonesStatus(connected=False, streaming=False, rate=RATE, source=source)

    def start(self, sessions: Sessions) -> None:
        """Declare the publication."""
        self._publication = sessions.publication(self._key, PCM, self._on_subscribed)

    @property
    def subscribed(self) -> bool:
        """Whether a client subscribes; listen only while this is True."""
        return self._publication is not None and self._publication.subscribed

    def publish(self, block: SoundBlock, /) -> None:
        """Publish a block, and report that the microphones work."""
        if self._publication is None:
            return
        self._seq = (self._seq + 1) % _SEQS
        header = SoundHeader(
            seq=self._seq,
            t_mono_ns=block.t_mono_ns,
            t_wall_ns=block.t_mono_ns + time.time_ns() - time.monotonic_ns(),
            rate=RATE,
            dropped=block.dropped % _SEQS,
            source=block.source,
        )
        self.report("")
        self._switch(on=True)
        if (block.source, header.dropped) != (self._status.source, self._status.dropped):
            with self._lock:
                self._status = msgspec.structs.replace(
                    self._status, source=block.source, dropped=header.dropped
                )
        # Publish last, so that a client that has the block reads a status that includes it.
        self._publication.put(block.samples, codec.encode(header))

    def ended(self) -> None:
        """Report that the microphones are off; the sensor calls it when no client subscribes any more."""
        self._switch(on=False)

    def _switch(self, *, on: bool) -> None:
        with self._lock:
            changed, self._on = on != self._on, on
        if changed and self._announce:
            text = "The microphones are on: a client listens." if on else "The microphones are off."
            self._events.add(EventKind.MICROPHONES, action="on" if on else "off", message=text)

    def report(self, trouble: str) -> None:
        """Set the fault of the microphones, and record a change as an event.

        `trouble`: a sentence with the cause and what to do; empty if they work.
        """
        with self._lock:
            before = self._status.trouble
            if self._status.connected == (not trouble) and before == trouble:
                return
            self._status = msgspec.structs.replace(self._status, connected=not trouble, trouble=trouble)
        if trouble == before:
            return
        reason = Reason.FAULT if trouble else Reason.OK
        text = trouble or "The microphones are connected again."
        self._events.add(EventKind.MICROPHONES, reason=reason, message=text)

    def status(self) -> MicrophonesStatus:
        """Return the present state of the microphones."""
        with self._lock:
            return msgspec.structs.replace(self._status, streaming=self._on)

    def contribute(self, status: StatusFields) -> None:
        """Add the state of the microphones to a status, and their fault as a warning."""
        state = self.status()
        status.values["microphones"] = state
        if state.trouble:
            status.warnings.append(f"{TITLE}: {state.trouble}")


@dataclass(frozen=True)
class CameraFrame:
    """One picture."""

    jpeg: bytes
    width: int
    """pixels"""
    height: int
    """pixels"""
    t_mono_ns: int
    """monotonic clock of this computer at the exposure, or at the time of the rendered state"""
    source: str
    """`v4l2`, `opencv`, `pattern`, `file`, `egl`, `osmesa` or `rays`"""


class CameraPublisher:
    """Publishes the pictures of one camera; one thread may publish, any thread may read its status."""

    def __init__(self, key: str, events: NodeEvents, source: str, on_subscribed: Callable[[], None]) -> None:
        """Store the arguments; `start` declares the publication.

        Args:
            key: key of the publication, which ends with `left` or `right`; of simulations also with `outside`.
            events: the events of the node.
            source: source of the pictures, as in `CameraFrame`.
            on_subscribed: called when `subscribed` may have changed; may run on Zenoh's thread, must return at once.
        """
        self._key, self._events, self._on_subscribed = key, events, on_subscribed
        self._eye = eye = key.rpartition("/")[2]
        self._publication: Publication | None = None
        self._lock = threading.Lock()
        self._times_s: deque[float] = deque()
        self._seq = 0
        self._status = CameraStatus(
            eye=eye, connected=False, streaming=False, hz=0.0, width=0, height=0, source=source
        )

    def start(self, sessions: Sessions) -> None:
        """Declare the publication."""
        self._publication = sessions.publication(self._key, JPEG, self._on_subscribed)

    @property
    def subscribed(self) -> bool:
        """Whether a client subscribes; take pictures only while this is True."""
        return self._publication is not None and self._publication.subscribed

    def publish(self, frame: CameraFrame, /) -> None:
        """Publish a picture, and report that the camera works."""
        if self._publication is None:
            return
        self._seq = (self._seq + 1) % _SEQS
        header = FrameHeader(
            seq=self._seq,
            t_mono_ns=frame.t_mono_ns,
            t_wall_ns=frame.t_mono_ns + time.time_ns() - time.monotonic_ns(),
            width=frame.width,
            height=frame.height,
            source=frame.source,
        )
        self.report("")
        now_s = time.monotonic()
        with self._lock:
            self._times_s.append(now_s)
            self._forget(now_s)
            self._status = msgspec.structs.replace(
                self._status, width=frame.width, height=frame.height, source=frame.source
            )
        # Publish last, so that a client that has the picture reads a status that includes it.
        self._publication.put(frame.jpeg, codec.encode(header))

    def ended(self) -> None:
        """Do nothing: `streaming` follows from the subscribers."""

    def report(self, trouble: str) -> None:
        """Set the fault of the camera, and record a change as an event.

        `trouble`: a sentence with the cause and what to do; empty if the camera works.
        """
        with self._lock:
            before = self._status.trouble
            self._status = msgspec.structs.replace(self._status, connected=not trouble, trouble=trouble)
        if trouble == before:
            return
        reason = Reason.FAULT if trouble else Reason.OK
        text = trouble or "The camera is connected again."
        self._events.add(EventKind.CAMERA, action=self._eye, reason=reason, message=self._named(text))

    def status(self) -> CameraStatus:
        """Return the present state of the camera."""
        subscribed = self.subscribed
        with self._lock:
            self._forget(time.monotonic())
            times_s, camera = self._times_s, self._status
            span_s = times_s[-1] - times_s[0] if times_s else 0.0
            rate = (len(times_s) - 1) / span_s if subscribed and span_s else 0.0
            streaming = subscribed and bool(times_s)
        return msgspec.structs.replace(camera, streaming=streaming, hz=rate)

    def contribute(self, status: StatusFields) -> None:
        """Add the state of this camera to a status, and its fault as a warning."""
        camera = self.status()
        status.cameras.append(camera)
        if camera.trouble:
            status.warnings.append(self._named(camera.trouble))

    def _named(self, text: str) -> str:
        return f"{names.view_title(self._eye)}: {text}"

    def _forget(self, now_s: float) -> None:
        while self._times_s and now_s - self._times_s[0] > WINDOW_S:
            self._times_s.popleft()
