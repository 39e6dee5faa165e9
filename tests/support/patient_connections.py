"""Repeated connection attempts, for a router that a busy computer delays."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final, TypeVar

from beatrix_zenoh.contract.errors import NoAnswer

PATIENCE_S: Final = 20.0
T = TypeVar("T")


def patiently(connect: Callable[[], T]) -> T:
    """Try to connect for PATIENCE_S; raise the last NoAnswer if no attempt succeeds."""
    deadline, pause = time.monotonic() + PATIENCE_S, threading.Event()
    while True:
        try:
            return connect()
        except NoAnswer:
            if time.monotonic() > deadline:
                raise
            pause.wait(0.1)
