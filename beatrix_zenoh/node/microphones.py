"""Publish the sound of both microphones while a client subscribes, and report their state in the status.

It is used as `CameraPublisher` in camera.py is, with a `SoundBlock` in place of a picture.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import msgspec
import numpy as np
import numpy.typing as npt

from beatrix_zenoh.bus import Publication, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import EventKind, MicrophonesStatus, Reason, SoundHeader
from beatrix_zenoh.node.events import NodeEvents
from beatrix_zenoh.node.interfaces import StatusFields

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
