"""The session watchdog of a process with several robots."""

from __future__ import annotations

import queue
from types import SimpleNamespace
from typing import Any, cast

import pytest

from beatrix_zenoh import threads
from beatrix_zenoh.bus.sessions import CONTROL, SessionListener, SessionWatchdog
from beatrix_zenoh.threads import Owner

WAIT_S = 10.0


def test_the_watchdog_belongs_to_all_robots(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise its failure would start the first robot anew, and no thread would check the sessions any more."""
    monkeypatch.setattr("beatrix_zenoh.bus.sessions.PERIOD_S", 0.01)
    owners: queue.SimpleQueue[Owner | None] = queue.SimpleQueue()

    def opened() -> dict[str, Any]:
        owners.put(threads.OWNER.get())
        return {CONTROL: SimpleNamespace(connected=True)}

    watchdog = SessionWatchdog(opened)
    listener = SessionListener(cast("Any", None), cast("Any", None))
    with threads.owned_by(Owner("ada")):
        end = watchdog.add(listener)
    try:
        assert owners.get(timeout=WAIT_S) is None
    finally:
        end()
