"""A camera of the robot.

A thread takes pictures while a client subscribes, and reopens a camera that was unplugged.
"""

from __future__ import annotations

import logging
import threading
import time
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node import CameraPublisher, Component, Node, StatusFields
from hw_node.cameras.source import FrameSource

CHECK_S: Final = 1.0
"""Period of the check whether a camera that is not in use is present."""
WAIT_S: Final = 0.2
"""Longest wait for a picture before the thread checks whether a client still subscribes."""
SILENT_S: Final = 3.0
"""Longest time without a picture; some cameras need two seconds for the first one."""

log = logging.getLogger(__name__)


class Camera(Component):
    """One eye of the robot; failures of its camera do not affect the rest of the node."""

    def __init__(self, node: Node, eye: str, source: FrameSource) -> None:
        self._eye, self._source = eye, source
        self._wake = threading.Event()
        self._publisher = CameraPublisher(
            keys.camera(node.name, node.side, eye), node.events, source.name, self._wake.set
        )
        self._closed = False
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        self._publisher.start(sessions)
        self._thread = threads.start(self._run, f"camera-{self._eye}")

    def contribute(self, status: StatusFields) -> None:
        self._publisher.contribute(status)

    def _run(self) -> None:
        seen: str | None = None
        while not self._closed:
            trouble = self._source.trouble()
            # Report only changes: this check does not find problems with taking pictures, and must not end the report
            # of such a problem before a picture arrives.
            if trouble != seen:
                self._publisher.report(trouble)
            seen = trouble
            wanted = not trouble and self._publisher.subscribed
            if wanted and self._take_pictures():
                continue
            self._wake.wait(CHECK_S)
            self._wake.clear()

    def _take_pictures(self) -> bool:
        """Publish pictures while a client subscribes; if the camera fails, report that and return False."""
        try:
            try:
                self._source.open()
                self._publish()
            finally:
                self._source.close()
        except NoAnswer as error:
            self._publisher.report(error.message)
        except Exception as error:  # a bug here or in a library must not end the node
            log.exception("The %s eye failed.", self._eye)
            self._publisher.report(f"The camera failed: {error}. The node retries every second.")
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
                raise no_picture()

    def close(self) -> None:
        """End the thread."""
        self._closed = True
        self._wake.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)


def no_picture() -> NoAnswer:
    """Return the error for a camera that is present and delivers no pictures."""
    return NoAnswer(
        Reason.TIMED_OUT,
        f"The camera is plugged in but has delivered no picture for {SILENT_S:g} s. Unplug it, and plug it in again.",
    )
