"""What holds the hardware back during the lead of a motion of both robots."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable

from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Interrupted

POLL_S = 0.02
LATE_S = 1.5
"""A motion that is overdue by more than this (s) is not sent to the hardware: its program was suspended."""


class Lead:
    """Decides once whether a motion is sent to the hardware, and when; several threads and signal handlers may use it.

    The first caller of `claim` decides: the thread that sends the motion, or one that keeps it from being sent.
    """

    def __init__(self, lead_s: float) -> None:
        """Hold the hardware back for `lead_s` (s) from `begin` on."""
        self.lead_s = lead_s
        self.sent = False
        """Whether the motion was sent to the hardware."""
        self._due_s: float | None = None
        self._claimed = threading.Lock()
        """Acquired once and never released. It is a lock because acquiring it without waiting is atomic, also between
        a signal handler and the thread that it interrupts."""
        self._wakeups: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._check_both: Callable[[], None] = lambda: None
        self._check_present: Callable[[], None] = lambda: None
        self._stops: tuple[StopEvents, ...] = ()

    def claim(self) -> bool:
        """Return True for the first call, whose caller alone decides about the hardware; False for each further one."""
        return self._claimed.acquire(blocking=False)

    @property
    def countdown_s(self) -> float:
        """Seconds until the motion is sent to the hardware; 0 if it was sent or will not be sent."""
        if self._claimed.locked():
            return 0.0
        return self.lead_s if self._due_s is None else max(0.0, self._due_s - time.monotonic())

    def watch(
        self, check_both: Callable[[], None], check_present: Callable[[], None], stops: tuple[StopEvents, ...]
    ) -> None:
        """Have both robots checked during the lead; an exception of a check ends the motion.

        Args:
            check_both: called just before the motion is sent to the hardware.
            check_present: called continuously, because a robot that was not online may have been replaced.
            stops: STOP events of both robots since the simulation and the hardware were at rest.
        """
        self._check_both, self._check_present, self._stops = check_both, check_present, stops

    def begin(self) -> None:
        """Start the lead: the simulation has begun."""
        self._due_s = time.monotonic() + self.lead_s

    def send_now(self) -> bool:
        """End the lead now; return False if it has not begun, or the motion was sent or held before."""
        if self._due_s is None or self._claimed.locked():
            return False
        self._due_s = min(self._due_s, time.monotonic())
        self.wake()
        return True

    def wake(self) -> None:
        """End the current `wait`, or else the next one."""
        self._wakeups.put(None)

    def wait(self) -> None:
        """Wait one step, at most until the motion is due."""
        with contextlib.suppress(queue.Empty):
            self._wakeups.get(timeout=max(0.001, min(self._left_s(), POLL_S)))

    def due(self) -> bool:
        """Return whether the motion is now to be sent to the hardware, after all checks.

        Raises:
            Interrupted: STOP was pressed, or this program was suspended for too long.
            BeatrixError: a check of `watch` failed.
        """
        for stops in self._stops:
            stops.check(" before the motion was sent to the hardware")
        self._check_present()
        left_s = self._left_s()
        if left_s < -LATE_S:
            raise Interrupted(
                Reason.STOPPED,
                f"This program was suspended for {-left_s:.1f} s: the motion is too late for the hardware and was not sent.",
            )
        if left_s > 0 or self._claimed.locked():
            return False
        self._check_both()
        return True

    def _left_s(self) -> float:
        return (self._due_s or 0.0) - time.monotonic()

    def close(self) -> None:
        """End the subscriptions to STOP events."""
        for stops in self._stops:
            stops.close()
