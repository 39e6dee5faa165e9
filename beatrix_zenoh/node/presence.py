"""Presence: the claim of the name, the token of the robot, the tokens of clients, the connection to the router."""

from __future__ import annotations

import time
from collections.abc import Callable

from beatrix_zenoh.bus import Bus, Sessions
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind, Reason
from beatrix_zenoh.contract.errors import NoAnswer, Refused
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.events import new_event
from beatrix_zenoh.node.interfaces import Component
from beatrix_zenoh.node.known_sessions import RETURN_S, SETTLE_S
from beatrix_zenoh.node.requests import Requests


class ClientWatch(Component):
    """Declares the robot's token, watches the tokens of clients and the router, and listens to the session watchdog."""

    def __init__(self, requests: Requests, controller: MotionController) -> None:
        self._controller = controller
        self._alive_key = keys.alive(requests.name, requests.side)
        self._queue, self._events, self._access = requests.queue, requests.events, controller.access
        self._end_reports: Callable[[], None] = lambda: None
        self._control: Bus | None = None
        self._router_connected = True
        self._closed = False

    def has_router(self) -> bool:
        """Return whether a router is connected; any thread may call it."""
        # Zenoh may report a lost router a moment before it takes it from its list.
        return self._router_connected and self._control is not None and self._control.connected

    @property
    def _endpoint(self) -> str:
        return "" if self._control is None else self._control.endpoint

    def start(self, sessions: Sessions) -> None:
        self._control = control = sessions.control
        control.watch_tokens(keys.seat("*", "*"), self._seat)
        control.watch_tokens(keys.seats_router("*"), self._seats_router)
        control.watch_router(self._router)
        control.declare_token(self._alive_key)
        self._end_reports = sessions.watch_sessions(self._renewed, self._refused)

    def _seat(self, key: str, alive: bool) -> None:  # noqa: FBT001
        """Handle a client's session that has begun or ended, on Zenoh's thread."""
        parts = keys.parse(key)
        if parts is not None:
            caller = Caller(parts.who, parts.session)
            now_s = time.monotonic()
            self._queue.post_event(lambda: self._session_changed(caller, now_s, alive=alive))

    def _seats_router(self, _key: str, alive: bool) -> None:  # noqa: FBT001
        """Handle the end or return of the router of the seats of a class, on Zenoh's thread; others stay connected."""
        now_s = time.monotonic()
        self._queue.post_event(lambda: self._connection_changed(now_s, connected=alive))

    def _session_changed(self, caller: Caller, now_s: float, *, alive: bool) -> None:
        if self._access.session_changed(caller, now_s, alive=alive):
            self._controller.client_lost()
        if not alive:
            self._queue.post_later(now_s + SETTLE_S, self._give_up_sessions)

    def _give_up_sessions(self) -> None:
        if self._access.give_up_sessions(time.monotonic()):
            self._controller.client_lost()

    def _router(self, connected: bool) -> None:  # noqa: FBT001
        """Handle a lost or reconnected router, on Zenoh's thread."""
        if self._closed or connected == self._router_connected:
            return
        self._router_connected = connected
        now_s = time.monotonic()
        self._queue.post_event(lambda: self._router_changed(now_s, connected=connected))
        if connected:
            text = f"The router at {self._endpoint} is connected again."
            self._events.add(new_event(kind=EventKind.ROUTER, message=text))
            return
        text = (
            f"The router at {self._endpoint} was lost: the node stops all motions and receives no requests."
        )
        self._events.add(new_event(kind=EventKind.ROUTER, reason=Reason.NO_ROUTER, message=text))

    def _router_changed(self, now_s: float, *, connected: bool) -> None:
        self._connection_changed(now_s, connected=connected)
        if not connected:
            self._controller.client_lost()

    def _connection_changed(self, now_s: float, *, connected: bool) -> None:
        """Keep the leases of sessions that are missing because a router is lost, until they could have returned."""
        self._access.router_changed(now_s, connected=connected)
        if connected:
            self._queue.post_later(now_s + RETURN_S, self._give_up_sessions)

    def _renewed(self, traffic: str) -> None:
        """Stop the running motion, because the client of the old session may be gone without notice.

        Called on the watchdog's thread.
        """

        def end() -> None:
            text = f"The router had forgotten the {traffic} session; the node has connected again."
            self._controller.diagnostics.warn(text)
            self._controller.client_lost()

        self._queue.post_event(end)

    def _refused(self, error: NoAnswer) -> None:
        """Report that the router refuses the account, on the watchdog's thread."""
        text = f"{error.message} Then start the node again: until then it receives no requests."
        self._events.add(new_event(kind=EventKind.ROUTER, reason=error.reason, message=text))

    def close(self) -> None:
        """End the reports of the watchdog; the robot's token ends when the node closes its sessions."""
        self._closed = True
        self._end_reports()


WAIT_S = 3.0
"""Longest time (s) to wait until another claimant withdraws or serves; a node starts in less than two seconds."""
POLL_S = 0.02


def claim_name(sessions: Sessions, name: str, side: str) -> None:
    """Claim the name until the node closes its sessions, because two robots with one name would both carry out every request.

    Each node first declares its claim, then looks for other claims, so of two nodes at least one sees the other. The
    node with the larger session id withdraws its claim; the other node waits for this. If a node that looked earlier
    begins to serve, or after WAIT_S, the waiting node withdraws too.

    Raises:
        Refused: NAME_TAKEN; the claim was withdrawn.
    """
    bus = sessions.control
    alive, own = keys.alive(name, side), keys.claim(name, side, bus.session_id)
    if bus.tokens(alive):
        raise taken(bus, name, side)
    withdraw = bus.declare_token(own)
    deadline = time.monotonic() + WAIT_S
    while others := [other for other in bus.tokens(keys.claim(name, side, "*")) if other != own]:
        if min(others) < own or bus.tokens(alive) or time.monotonic() > deadline:
            withdraw()
            raise taken(bus, name, side)
        time.sleep(POLL_S)


def taken(bus: Bus, name: str, side: str) -> Refused:
    """Return the refusal of a second node with the same name."""
    return Refused(
        Reason.NAME_TAKEN,
        f"A {side} robot named {name!r} is already online at {bus.endpoint}. Start this robot under another "
        "name (--name), or end the other robot; `beatrix ls` lists the robots.",
    )
