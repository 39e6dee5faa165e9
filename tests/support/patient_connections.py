"""Repeated connection attempts, for a router that a busy computer delays."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final, TypeVar

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer

PATIENCE_S: Final = 20.0
T = TypeVar("T")


def patiently(connect: Callable[[], T]) -> T:
    """Try for PATIENCE_S, also while the robot is busy; raise the last error if no attempt succeeds."""
    deadline, pause = time.monotonic() + PATIENCE_S, threading.Event()
    while True:
        try:
            return connect()
        except BeatrixError as error:
            if time.monotonic() > deadline or not (
                isinstance(error, NoAnswer) or error.reason is Reason.BUSY
            ):
                raise
            pause.wait(0.1)
