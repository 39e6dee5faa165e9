"""Warnings for the user in the status: those of the last seconds, and one after a restart of the board."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from beatrix_zenoh.contract._generated.messages import EventKind, Reason
from beatrix_zenoh.node.events import EventLog

SHOWN_S = 10.0
LENGTH = 5
RESTARTED = "The board was restarted, and home is not known. Set the head upright, enable, calibrate."


class Diagnostics:
    """The newest warnings; written on one thread, read on any."""

    def __init__(self, events: EventLog, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        self._events, self._monotonic_s = events, monotonic_s
        self._warnings: deque[tuple[float, str]] = deque(maxlen=LENGTH)
        self._boot = 0
        self._restarted = False

    def warn(self, text: str, reason: Reason = Reason.OK) -> None:
        """Record a sentence as an event and show it for SHOWN_S; a repetition replaces the earlier warning."""
        others = [warning for warning in self._warnings if warning[1] != text]
        self._warnings = deque([*others, (self._monotonic_s(), text)], maxlen=LENGTH)
        self._events.add(EventKind.WARNING, reason=reason, message=text)

    def follow_boot(self, boot: int, *, calibrated: bool) -> None:
        """Compare the boot number with the last one; after a restart record an event and warn until calibration."""
        restarted = bool(self._boot and boot != self._boot) and not calibrated
        if restarted:
            self._events.add(EventKind.BOARD, message=RESTARTED)
        self._restarted = not calibrated and (self._restarted or restarted)
        self._boot = boot

    def warnings(self) -> list[str]:
        """Return the warnings to show now."""
        now_s = self._monotonic_s()
        recent = [text for at_s, text in list(self._warnings) if now_s - at_s < SHOWN_S]
        return [RESTARTED, *recent] if self._restarted else recent
