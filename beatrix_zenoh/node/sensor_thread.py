"""A sensor of the robot: a thread that reads its device only while a client subscribes, and survives its failures."""

from __future__ import annotations

import logging
import threading
import time
from abc import abstractmethod
from typing import Final, Generic, Protocol, TypeVar

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node.interfaces import Component, StatusFields
from beatrix_zenoh.node.sensors import SensorFrame, SensorPublisher

CHECK_S: Final = 1.0
"""Period of the check whether a device that is not in use is present."""
WAIT_S: Final = 0.2
"""Longest wait for a frame before the thread checks whether a client still subscribes."""
SILENT_S: Final = 3.0
"""Longest time without a frame; some cameras need two seconds for the first one."""

log = logging.getLogger(__name__)

T = TypeVar("T", bound=SensorFrame)
T_co = TypeVar("T_co", covariant=True)


class SensorSource(Protocol[T_co]):
    """A camera, two microphones, what stands in for them, or simulated ones; used by one thread.

    `open` and `next` raise NoAnswer, with a message that says what to do, if there are no frames.
    """

    @property
    def name(self) -> str:
        """Kind of source, as in the status."""

    def trouble(self) -> str:
        """Return why there can be no frame now, empty if no reason is known; quick, and does not open the source."""

    def open(self) -> None:
        """Start taking frames."""

    def next(self, timeout_s: float) -> T_co | None:
        """Wait for the next frame and return it; None if none arrives within `timeout_s`."""

    def close(self) -> None:
        """Stop taking frames; may be called twice, and after `open` has failed."""


class Sensor(Component, Generic[T]):
    """Publishes the frames of a source; its failures do not affect the rest of the node."""

    check_s: float | None = CHECK_S
    """Period (s) of the check of a source that is not in use; None: it is always present."""

    def __init__(
        self,
        title: str,
        source: SensorSource[T],
        publisher: SensorPublisher,
        wake: threading.Event,
        silence: str,
    ) -> None:
        """Store the arguments; `start` starts the thread.

        Args:
            title: the sensor in the log.
            source: where the frames come from.
            publisher: publishes them; sets `wake` when a client subscribes.
            wake: wakes the thread.
            silence: a sentence for a device that is present and delivers nothing for SILENT_S.
        """
        self._title, self._source, self._publisher = title, source, publisher
        self._wake, self._silence = wake, silence
        self._failed = ""
        """the last unexpected error"""
        self._closed = False
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        self._publisher.start(sessions)
        self._thread = self.start_thread()

    @abstractmethod
    def start_thread(self) -> threading.Thread:
        """Start the thread that calls `run`."""

    def contribute(self, status: StatusFields) -> None:
        self._publisher.contribute(status)

    def run(self) -> None:
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
            self._wake.wait(CHECK_S if wanted else self.check_s)
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
