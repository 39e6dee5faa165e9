"""The session of the window, kept while the router is lost and returns, and the queries that measure each robot."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from beatrix_zenoh.client.monitor import Monitor, Presence, RobotState, Seats
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Info, LimitInfo, Reason, Source
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.settings import Settings
from gui.console.link.jobs import Job, Jobs, Repeated
from gui.console.state.world import LinkPhase

RETRY_S = 1.0
REFUSALS = 2
"""Refusals in a row after which the account counts as refused: a router that has just started may refuse it once."""
LOOK_S = 0.25
"""Period of reading the names of robots online, until one is selected."""
EVENTS = 200
"""Number of events kept for each robot."""
PROBE_S, PROBE_SHARED_S = 1.0, 5.0
"""Periods of the queries of a window, and of each of the many pages of one process."""
ANSWER_S = 1.0


@dataclass(frozen=True)
class Session:
    """A session with the router, and the objects that use it."""

    client: Client
    monitor: Monitor
    """the states of all robots of the router; only one thread reads them, for a window Qt's"""
    twin: Twin
    """both robots of the chosen name"""
    seats: Seats
    """the seats that are connected to the router"""

    def close(self) -> None:
        """Close the session, so that robots stop its motions; a slow router delays the return."""
        self.client.close()
        self.twin.close()


class Connection:
    """Looks for the router in a queue of the jobs until there is a session, which stays open until `close`.

    A session whose router is lost recovers by itself when the router returns.
    """

    def __init__(
        self,
        settings: Settings,
        jobs: Jobs,
        on_session: Callable[[], None],
        *,
        name_given: bool,
        source: Source,
        shared: Session | None,
    ) -> None:
        """Store the arguments; `look` begins to look for the router.

        Args:
            settings: robot, router and seat.
            jobs: the executor.
            on_session: called when there is a session, and when another robot is selected; must not wait.
            name_given: whether the user chose the robot, which then stays selected even if only another one is online.
            source: the face, for the events of robots.
            shared: a session whose states of robots and seats this one reads, too; None: it receives them itself.
        """
        self.settings = settings
        self.robot = settings.robot
        self.session: Session | None = None
        self._client: Client | None = None
        """the newest client: reports about the router of an older one are ignored"""
        self._on_session, self._chosen = on_session, name_given
        self._source, self._shared = source, shared
        self._router_present = True
        self._error: BeatrixError | None = None
        """why there is no session, or why the router refuses the account; None: neither is known"""
        self._refusals = 0
        self._lock = threading.Lock()
        self._closed = False
        self._jobs, self._steps = jobs, Repeated(jobs, "connection", RETRY_S)

    @property
    def phase(self) -> LinkPhase:
        """Whether the router answers, and accepts the account."""
        if self._error is not None and self._error.reason is Reason.ACCOUNT_REFUSED:
            return LinkPhase.REFUSED
        if self.session is None:
            return LinkPhase.CONNECTING if self._error is None else LinkPhase.NO_ROUTER
        return LinkPhase.ONLINE if self._router_present else LinkPhase.NO_ROUTER

    @property
    def trouble(self) -> str:
        """The reason why there is no session, router or access; empty if all exist."""
        if self._error is not None:
            return self._error.message
        if self.session is None or self._router_present:
            return ""
        return (
            f"The router at {self.settings.connect} is lost or does not answer, so the robots stop their motions. The window "
            "reconnects when the router returns."
        )

    @property
    def missing(self) -> NoAnswer:
        """The error of a request while there is no session."""
        reason = Reason.ACCOUNT_REFUSED if self.phase is LinkPhase.REFUSED else Reason.NO_ROUTER
        return NoAnswer(
            reason, self.trouble or f"The window is looking for the router at {self.settings.connect}."
        )

    @property
    def where(self) -> tuple[str, str]:
        """The name of the selected robot, and the address of the router."""
        return self.robot, self.settings.connect

    def look(self, now_s: float) -> None:
        """Look for router and robot again if it is time; returns at once. Call it often, in one thread only."""
        self._steps.look(now_s, self._step)

    def try_now(self) -> None:
        """Look now for the router and whether it accepts the account."""
        self._put(self._connect if self.session is None else self._check_account)

    def _put(self, job: Job) -> None:
        self._jobs.put("connection", job)

    def change(self, settings: Settings, *, name_given: bool) -> None:
        """Close the session, and look for the router of these settings from now on; returns at once."""
        with self._lock:
            old, self.session, self._client = self.session, None, None
            self.settings, self.robot, self._chosen = settings, settings.robot, name_given
            self._router_present, self._error, self._refusals = True, None, 0
        if old is not None:
            self._put(old.close)  # it may wait for a robot
        self.try_now()

    def select(self, robot: str) -> None:
        """Watch and drive the robots of another name from now on, through the same session; returns at once."""
        with self._lock:
            self._chosen = True
            self._select(robot)

    def _select(self, robot: str) -> None:
        old, self.robot = self.session, robot
        if old is None or old.twin.name == robot:
            return
        self.session = replace(old, twin=Twin(robot, client=old.client))
        self._on_session()
        self._put(old.twin.close)  # it may wait for a robot

    def states(self, robot: str) -> tuple[RobotState, RobotState]:
        """Return the states of simulation and hardware of a name."""
        session = self.session
        if session is None:
            return absent(robot, "sim"), absent(robot, "hw")
        return session.monitor.robot(robot, "sim"), session.monitor.robot(robot, "hw")

    def names(self) -> tuple[str, ...]:
        """Return the names of the robots online, sorted."""
        session = self.session
        return () if session is None else tuple(sorted({name for name, _ in session.monitor.present()}))

    # -- one after the other -----------------------------------------------------------------------

    def _step(self) -> None:
        """Look for router or robot once."""
        try:
            if self.session is None:
                self._connect()
            elif self._router_present or self._error is not None:
                self._choose()
            else:
                self._check_account()
        finally:
            chooses = self.phase is LinkPhase.ONLINE and not self._chosen
            self._steps.period_s = LOOK_S if chooses else RETRY_S

    def _connect(self) -> None:
        settings = self.settings
        if self.session is not None:
            return
        try:
            client = Client(settings, source=self._source)
        except BeatrixError as error:
            self._note(error, settings)
            return
        self._client = client
        try:
            client.bus.watch_router(lambda present: self._on_router(client, present=present))
            shared = self._shared
            monitor = Monitor(client, events=EVENTS) if shared is None else shared.monitor
            seats = Seats(client) if shared is None else shared.seats
        except BeatrixError as error:  # the router was lost meanwhile
            client.close()
            self._note(error, settings)
            return
        with self._lock:
            if not self._closed and settings is self.settings:
                self._error = None
                self.session = Session(client, monitor, Twin(self.robot, client=client), seats)
                self._on_session()
                return
        client.close()

    def _note(self, error: BeatrixError, settings: Settings) -> None:
        """Store why there is no session, unless other settings were chosen meanwhile."""
        with self._lock:
            if settings is self.settings:
                self._error = error

    def _on_router(self, client: Client, *, present: bool) -> None:
        if client is not self._client:
            return
        if present and not self._router_present:
            self._put(self._check_account)
        self._router_present = present

    def _check_account(self) -> None:
        """Look whether a router that is lost or has returned refuses the account."""
        session = self.session
        if session is None or self._closed:
            return
        error = session.client.bus.refusal()
        if session is not self.session:
            return
        self._refusals = 0 if error is None else self._refusals + 1
        self._error = error if self._refusals >= REFUSALS else None

    def _choose(self) -> None:
        """Select a name once, if the user chose none: the only one online or, for the teacher, one of several.

        Usually no robot has the default name of the teacher's window. Then the first hardware is selected, because
        simulations belong to students.
        """
        with self._lock:
            session = None if self._chosen else self.session
            if session is None:
                return
            first = sorted(session.monitor.present(), key=lambda place: (place[1] != "hw", place[0]))
            names = {name for name, _ in first}
            if len(names) == 1 or (names and self.settings.who == TEACHER):
                self._chosen = True
                self._select(self.robot if self.robot in names else first[0][0])

    # -- the end ------------------------------------------------------------------------------------

    def close(self) -> None:
        """Close the session, so that robots stop its motions; a slow router delays the return."""
        with self._lock:
            self._closed = True
            session = self.session
        if session is not None:
            session.close()


def absent(robot: str, side: str) -> RobotState:
    """Return the state of a robot that has published nothing."""
    return RobotState(robot, side, Presence.ABSENT, None, None, None, None, 0.0, ())


class Probe:
    """Queries one robot in a queue of its own, so that a silent robot does not delay queries to the other."""

    def __init__(self, side: str, jobs: Jobs, period_s: float) -> None:
        self._side, self._queries = side, Repeated(jobs, f"probe-{side}", period_s)
        self.round_trip_s: float | None = None
        """duration (s) of the last query; None: the robot did not answer, or no query was sent"""
        self._limits: tuple[Place, LimitInfo] | None = None

    def limits(self, robot: str) -> LimitInfo | None:
        """Return the limits of the robot of this name; None if it has not answered since it came online."""
        known = self._limits
        return known[1] if known is not None and known[0] == (robot, self._side) else None

    def look(self, session: Session | None, now_s: float) -> None:
        """Query the robot again if it is time; returns at once. Call it in one thread only."""
        place = ("" if session is None else session.twin.name, self._side)
        if session is None or place not in session.monitor.present():
            self.round_trip_s = self._limits = None  # the next robot of this name may have other limits
        else:
            client = session.client
            self._queries.look(now_s, lambda: self._query(client, place))

    def _query(self, client: Client, place: Place) -> None:
        began_s = time.monotonic()
        try:
            self._limits = place, ask(client, place, keys.info(*place), None, Info, ANSWER_S).limits
            self.round_trip_s = time.monotonic() - began_s
        except BeatrixError:
            self.round_trip_s = None
