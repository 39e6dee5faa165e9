"""The process that measures how long this computer delays a process."""

from __future__ import annotations

import os
import signal
import threading
import time

from robots import until
from stall_monitor import STALL_S, Witness


def test_a_suspended_process_reports_its_delay() -> None:
    witness = Witness()
    try:
        until(lambda: witness.began, "it measures")
        begin_s = time.monotonic()
        os.kill(witness.pid, signal.SIGSTOP)
        threading.Event().wait(2 * STALL_S)
        os.kill(witness.pid, signal.SIGCONT)
        until(lambda: witness.paused_s(begin_s) > STALL_S, "it reports the delay")
        assert witness.paused_s(time.monotonic()) == 0.0
    finally:
        witness.close()
