"""The executor of the link: it runs the jobs of a queue in order, those of others beside them, and survives errors."""

from __future__ import annotations

import threading
import time

import pytest

from gui.console.link.jobs import Jobs


def test_an_error_goes_to_the_excepthook_and_later_jobs_run(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[BaseException | None] = []
    monkeypatch.setattr(threading, "excepthook", lambda arguments: shown.append(arguments.exc_value))
    order: list[int] = []
    wrong = ValueError("unforeseen")

    def fail() -> None:
        raise wrong

    jobs = Jobs("tested")
    jobs.put("a", lambda: order.append(1))
    jobs.put("a", fail)
    jobs.put("a", lambda: order.append(2))
    jobs.close()
    jobs.join(time.monotonic() + 5)
    assert (order, shown) == ([1, 2], [wrong])


def test_a_waiting_job_delays_neither_callers_nor_other_queues_nor_the_end() -> None:
    go_on, done = threading.Event(), threading.Event()
    jobs = Jobs("tested")
    began_s = time.monotonic()

    def wait() -> None:
        go_on.wait(10)

    jobs.put("a", wait)
    jobs.put("b", done.set)
    assert done.wait(5)
    jobs.close()
    jobs.put("b", done.clear)
    jobs.join(time.monotonic() + 0.1)
    assert time.monotonic() - began_s < 1.0
    go_on.set()
    jobs.join(time.monotonic() + 5)
    assert done.is_set(), "no job begins after the end"
