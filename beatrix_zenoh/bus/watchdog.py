"""The session watchdog: it checks each session by a query through another one, and the account after a router loss."""

from __future__ import annotations

import threading
from collections.abc import Callable

from beatrix_zenoh import threads
from beatrix_zenoh.bus.session import HEALTH, HEALTHY, Bus
from beatrix_zenoh.bus.sessions import Sessions
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage

PERIOD_S = 1.0
ANSWER_S = 1.0
FAILURES = 2
"""Failed checks in a row before a session is renewed; just after a reconnection one check may fail."""


class SessionWatchdog:
    """A thread that replaces a session whose queryables the router has lost.

    If the router disconnects a session under a flood of messages, Zenoh 1.10 reconnects it without its declarations in
    about one case in ten. The session is then open, but the router delivers no query to it. `renewed` is called with
    the traffic class, on the watchdog's thread.

    If the router is back after a loss and refuses the account, or has no rules for it, `refused` is called once on the
    same thread, because Zenoh tries to connect for ever, or drops all messages, and reports nothing.
    """

    def __init__(
        self,
        sessions: Sessions,
        token: str,
        renewed: Callable[[str], None],
        refused: Callable[[NoAnswer], None],
    ) -> None:
        """Start the thread; `token` is one that the control session has declared."""
        self._sessions, self._renewed, self._refused = sessions, renewed, refused
        self._token, self._without_rights = token, False
        self._refusals = 0
        self._failures: dict[str, int] = {}
        self._closed = threading.Event()
        self._thread = threads.start(self._run, "watchdog")

    def _run(self) -> None:
        while not self._closed.wait(PERIOD_S):
            opened = self._sessions.opened()
            for traffic, checked in opened.items():
                others = [bus for bus in opened.values() if bus is not checked]
                if others and checked.served and not self._closed.is_set():
                    self._check(traffic, checked, others[0])
            if not self._closed.is_set():
                self._check_account(self._sessions.control)

    def _check(self, traffic: str, checked: Bus, through: Bus) -> None:
        failed = not reached(checked, through)
        self._failures[traffic] = self._failures.get(traffic, 0) + 1 if failed else 0
        if self._failures[traffic] < FAILURES:
            return
        self._failures[traffic] = 0
        control = self._sessions.control
        if self._without_rights and checked is not control:
            return
        try:
            checked.renew()
        except NoAnswer:
            return  # the router has just been lost; the old session remains
        except WrongUsage:
            return  # the node closes
        error = control.refusal(self._token) if checked is control else None
        if error is None:
            self._without_rights = False
            self._renewed(traffic)
        elif not self._without_rights:
            self._without_rights = True
            self._refused(error)

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
                self._refused(error)

    def close(self) -> None:
        """End the watchdog's thread."""
        self._closed.set()
        self._thread.join(timeout=3 * ANSWER_S)


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
