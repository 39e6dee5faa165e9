"""The session watchdog, which replaces a session that the router has forgotten."""

from __future__ import annotations

import itertools
import threading
import weakref
from collections.abc import Callable
from typing import NamedTuple

from beatrix_zenoh import threads
from beatrix_zenoh.bus.messages import HEALTH, HEALTHY
from beatrix_zenoh.bus.session import Bus
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage

CONTROL = "control"
"""Traffic class of tokens, STOP and commands; its session is always open and is closed last."""
PERIOD_S = 1.0
ANSWER_S = 1.0
FAILURES = 2
"""Failed checks in a row before a session is renewed; just after a reconnection one check may fail."""


class SessionListener(NamedTuple):
    """What a node gives to the watchdog."""

    renewed: Callable[[str], None]
    """called with the traffic class of a session that was replaced"""
    refused: Callable[[NoAnswer], None]
    """called when the router refuses the account"""


class SessionWatchdog:
    """A thread that replaces a session whose queryables the router has lost; it runs while there are listeners.

    If the router disconnects a session under a flood of messages, Zenoh 1.10 reconnects it without its declarations in
    about one case in ten. The session is then open, but the router delivers no query to it.

    If the router is back after a loss and refuses the account, it reports that to the listeners once, because Zenoh tries
    to connect for ever and reports nothing.
    """

    def __init__(self, opened: Callable[[], dict[str, Bus]]) -> None:
        """`opened` returns the sessions to check by traffic class, the control session first."""
        self._opened = opened
        self._lock = threading.Lock()
        self._listeners: dict[SessionListener, Callable[[], dict[str, Bus]]] = {}
        """The listeners, each with a function that returns the sessions of its node that no other node uses."""
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._refusals = 0
        self._failures: weakref.WeakKeyDictionary[Bus, int] = weakref.WeakKeyDictionary()

    def add(self, listener: SessionListener, own: Callable[[], dict[str, Bus]] = dict) -> Callable[[], None]:
        """Report to a listener, on the watchdog's thread, and check the sessions that `own` returns for it alone.

        Of these one is checked in each period, because a process may have a hundred. Return a function that ends this.
        """
        with self._lock:
            self._listeners = {**self._listeners, listener: own}
            if self._thread is None:
                self._ended = ended = threading.Event()
                with threads.owned_by(None):  # not by the robot that adds the first listener
                    self._thread = threads.start(lambda: self._run(ended), "watchdog")
        return lambda: self._remove(listener)

    def _remove(self, listener: SessionListener) -> None:
        """End the reports to a listener; with the last one end the thread."""
        with self._lock:
            self._listeners = {other: own for other, own in self._listeners.items() if other is not listener}
            thread = None if self._listeners else self._thread
            if thread is not None:
                self._ended.set()
                self._thread = None
        if thread is not None:
            thread.join(timeout=3 * ANSWER_S)

    def _run(self, ended: threading.Event) -> None:
        for turn in itertools.count():
            if ended.wait(PERIOD_S):
                return
            opened = self._opened()
            control, *others = opened.values()
            for traffic, checked in opened.items():
                through = next(iter(others), None) if checked is control else control
                if through is not None and not ended.is_set():
                    self._check(traffic, checked, through, list(self._listeners))
            for listener, own in self._listeners.items():
                sessions = list(own().items())
                if sessions and not ended.is_set():
                    self._check(*sessions[turn % len(sessions)], control, [listener])
            if not ended.is_set():
                self._check_account(control)

    def _check(self, traffic: str, checked: Bus, through: Bus, listeners: list[SessionListener]) -> None:
        if not checked.served:
            return
        failed = not reached(checked, through)
        self._failures[checked] = self._failures.get(checked, 0) + 1 if failed else 0
        if self._failures[checked] < FAILURES:
            return
        del self._failures[checked]
        try:
            checked.renew()
        except NoAnswer:
            return  # the router has just been lost; the old session remains
        except WrongUsage:
            return  # the node closes
        for listener in listeners:
            listener.renewed(traffic)

    def _check_account(self, control: Bus) -> None:
        """Report a router that refuses the account twice in a row; one that has just started may refuse it once."""
        if control.connected:
            self._refusals = 0
        elif self._refusals < FAILURES:
            error = control.connection_error()
            if error is None or error.reason is not Reason.ACCOUNT_REFUSED:
                self._refusals = 0
                return
            self._refusals += 1
            if self._refusals == FAILURES:
                for listener in self._listeners:
                    listener.refused(error)


def reached(checked: Bus, through: Bus) -> bool:
    """Return False if the router passes no query to `checked`; True if it does, or if this is unknown."""
    if not (through.connected and checked.connected):
        return True
    query = through.query(f"{checked.served}?{HEALTH}")
    try:
        while (answer := query.next(ANSWER_S)) is not None:
            if answer.error and answer.payload == HEALTHY:
                return True
    except TimeoutError:
        return True
    finally:
        query.close()
    return False
