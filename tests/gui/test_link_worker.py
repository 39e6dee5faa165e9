"""The threads of the link: they run jobs in order and survive errors."""

from __future__ import annotations

import threading
import time

import pytest

from gui.console.link.worker import Worker


def test_an_error_goes_to_the_excepthook_and_later_jobs_run(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[BaseException | None] = []
    monkeypatch.setattr(threading, "excepthook", lambda arguments: shown.append(arguments.exc_value))
    order: list[int] = []
    wrong = ValueError("unforeseen")

    def fail() -> None:
        raise wrong

    worker = Worker("tested")
    worker.put(lambda: order.append(1))
    worker.put(fail)
    worker.put(lambda: order.append(2))
    worker.close()
    worker.join(time.monotonic() + 5)
    assert (order, shown) == ([1, 2], [wrong])


def test_a_waiting_job_delays_neither_callers_nor_the_end() -> None:
    go_on = threading.Event()
    worker = Worker("tested")
    began_s = time.monotonic()

    def wait() -> None:
        go_on.wait(10)

    worker.put(wait)
    worker.close()
    worker.join(time.monotonic() + 0.1)
    assert time.monotonic() - began_s < 1.0
    go_on.set()
    worker.join(time.monotonic() + 5)
