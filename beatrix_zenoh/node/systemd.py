"""Reports to systemd that the node works (sd_notify(3)), for `WatchdogSec` of its service."""

from __future__ import annotations

import contextlib
import os
import socket
import sys
import time
from typing import Final

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.node.interfaces import Component
from beatrix_zenoh.node.requests import ControllerQueue
from beatrix_zenoh.schedule import Schedule, ScheduledTask
from beatrix_zenoh.threads import Owner

ADDRESS: Final = "NOTIFY_SOCKET"
"""Variable with the address of systemd's socket; only a service of `Type=notify` has it."""
PERIOD_S: Final = 2.0
"""Period of the reports (s), a fifth of `WatchdogSec` in deploy/beatrix-hw.service."""


class SystemdReports(Component):
    """Sends each report through the threads of clock and controller, so that a hang of one of them ends the reports."""

    def __init__(self, queue: ControllerQueue, owner: Owner, clock: Schedule) -> None:
        self._queue, self._owner, self._clock = queue, owner, clock
        self._task: ScheduledTask | None = None

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        if os.environ.get(ADDRESS):
            self._task = self._clock.add(self._owner, self._post)
            self._task.wake()

    def _post(self) -> float:
        self._queue.post_event(report)
        return time.monotonic() + PERIOD_S

    def close(self) -> None:
        """End the reports."""
        if self._task is not None:
            self._clock.remove(self._task)


def report() -> None:
    """Send a report, if systemd wants it, without waiting: the service is ready, and works."""
    address = os.environ.get(ADDRESS)
    if address and sys.platform != "win32":
        # The first byte of an abstract address is 0, which the variable cannot contain.
        to = address.replace("@", "\0", 1)
        with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            sender.sendto(b"READY=1\nWATCHDOG=1", socket.MSG_DONTWAIT, to)
