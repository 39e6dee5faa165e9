"""Whether a router answers: a router can run and be stuck, and then nothing but its end helps."""

from __future__ import annotations

import threading
from typing import Final

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.account import Account
from beatrix_zenoh.classroom.router_file import CHECK_KEY
from beatrix_zenoh.contract.errors import NoAnswer

PERIOD_S, ANSWER_S = 1.0, 2.0
"""Time between two queries, and longest time until an answer (s)."""
FAILURES: Final = 3
"""Queries without an answer, one after the other, after which a router counts as stuck. Two may also fail because the
computer was asleep."""


class Answering:
    """Asks the router of robots and teacher once a second, on a thread of its own.

    It sends a query as clients do: one for tokens may take a second after a seat with 2 000 subscribers has left, while
    STOP takes 10 ms (measured).
    """

    def __init__(self, endpoint: str, account: Account) -> None:
        """Connect to one of the routers, and ask through it until `close`."""
        self._endpoint, self._account = endpoint, account
        self.failures = 0
        """number of queries without an answer, since the last answer"""
        self._ended = threading.Event()
        self._thread = threads.start(self._run, "answering")

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                bus = zbus.connect(self._endpoint, account=self._account)
            except NoAnswer:  # strangers may keep sessions out of a router that serves all others
                self._ended.wait(PERIOD_S)
                continue
            with bus:
                while not self._ended.wait(PERIOD_S):
                    self.failures = 0 if self._asked(bus) else self.failures + 1

    def _asked(self, bus: zbus.Bus) -> bool:
        query = bus.query(CHECK_KEY, timeout_s=ANSWER_S)
        return next(query.replies(ANSWER_S), None) is not None

    def close(self) -> None:
        """End the queries; call it after the end of the router, which may let no session close."""
        self._ended.set()
        self._thread.join(3 * ANSWER_S)
