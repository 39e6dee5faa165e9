"""All robots at the router: their states for the page of the class, and lease queries of the teacher."""

from __future__ import annotations

from collections.abc import Callable

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.lease import govern, pending
from beatrix_zenoh.contract._generated.messages import LeaseQuery
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session
from gui.console.link.outcomes import of_several
from gui.console.state.actions import Govern, Outcome

PERIOD_S = 0.2
"""Period of reading all states: decoding 60 of them takes milliseconds, too long for each refresh of the window."""


class ClassStates:
    """The states of all robots online, read only while they are shown; used in Qt's thread only."""

    def __init__(self) -> None:
        self._watched = False
        self._read_s = 0.0
        self._states: tuple[RobotState, ...] = ()

    def watch(self, *, on: bool) -> None:
        """Begin or end reading."""
        self._watched, self._read_s, self._states = on, 0.0, ()

    def states(self, session: Session | None, now_s: float) -> tuple[RobotState, ...]:
        """Return the states, at most PERIOD_S old, by name, the simulation first; empty unless watched."""
        if session is None or not self._watched:
            return ()
        if now_s - self._read_s >= PERIOD_S:
            found = session.monitor.robots()
            self._states = tuple(robot for robot in found if robot.presence is not Presence.ABSENT)
            self._read_s = now_s
        return self._states


def send_govern(action: Govern, session: Session, report: Callable[[Outcome], None]) -> None:
    """Send a lease query to several robots at the same time; report one outcome when they have answered."""
    places = action.places or tuple(sorted(session.monitor.present()))
    query = LeaseQuery(action=action.action, speed=action.speed, seat=action.seat)
    results = dict(govern(session.client, places, query))
    later = {} if action.places else pending(session.client, query)
    failed = {place: found for place, found in results.items() if isinstance(found, BeatrixError)}
    report(of_several(action.row, len(results) or len(later), failed))
