"""Turns of tests in several processes."""

from __future__ import annotations

import threading
from pathlib import Path

from file_locks import Turns


def test_a_test_that_runs_alone_waits_for_running_tests_and_later_tests_wait_for_it(tmp_path: Path) -> None:
    order: list[str] = []
    begun = threading.Event()

    def alone() -> None:
        begun.set()
        with Turns(tmp_path).turn(alone=True):
            order.append("alone")

    thread = threading.Thread(target=alone)
    with Turns(tmp_path).turn(alone=False), Turns(tmp_path).turn(alone=False):
        thread.start()
        assert begun.wait(10)
        order.append("side by side")
    thread.join(10)
    with Turns(tmp_path).turn(alone=False):
        order.append("next")
    assert order == ["side by side", "alone", "next"]
