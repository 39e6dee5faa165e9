"""The cause of a missing answer, found from the connection, the liveliness tokens and the robot's publications.

Zenoh 1.10 does not report the cause: a query ends without a reply if the robot is absent or has crashed, and also if
the access rules of the router refuse it. The checks here take up to 3 s, so they run only after a query has failed.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Collection
from dataclasses import dataclass, field

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Bus, Received
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract import sentences
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, Reason
from beatrix_zenoh.contract.errors import NoAnswer

ROUTER_S = 1.0
"""A router that needs longer than this (s) for a query about tokens counts as unresponsive."""
NOTICE_S = 0.2
"""Time (s) to wait for the report of a loss: Zenoh ends the queries of a lost connection before it reports the loss."""
BACK_S = 0.6
"""Zenoh restores a lost connection within this time (s) if the router answers."""
POLL_S = 0.02
ABSENT_S = 1.5
"""A query that reaches no node ends within this time (s). If one ends later without a reply, its node has ended."""
POSITIONS_S = 1.0
"""A node that publishes no positions for this long (s) counts as NODE_HANGS; it publishes them every 20 ms."""
CLOCK_S = 1.0
"""Time limit (s) of the query for the clock, which every account may send."""


@dataclass(frozen=True)
class Unanswered:
    """A query that was sent to one robot."""

    client: Client
    place: Place
    losses: int
    """number of losses of the router before the query"""
    began_s: float = field(default_factory=time.monotonic)

    def explain(self, limit_s: float | None = None, *, heard: bool = False) -> NoAnswer:
        """Return the error of a query without a reply: within `limit_s` (s) or, with None, until the query ended.

        `heard`: the query had an earlier reply.
        """
        waited_s = time.monotonic() - self.began_s
        error = self._disconnected(limit_s, heard=heard)
        if error is not None:
            return error
        received = heard or waited_s > ABSENT_S
        try:
            present = self.client.robots()
        except NoAnswer as refused:
            return refused
        if self._lost():
            return self._interrupted()
        if self.place not in present:
            known = received or self.place in self.client.seen
            return self._lost_node() if known else absence(self.client, self.place, present)
        if limit_s is not None:
            return self._late(limit_s)
        return self._lost_node(back=True) if received else self._refused()

    # -- the router ---------------------------------------------------------------------------------

    def _disconnected(self, limit_s: float | None, *, heard: bool) -> NoAnswer | None:
        """Return the error of a closed or lost connection, or of a lost or unresponsive router; otherwise None."""
        bus = self.client.bus
        if bus.closed:
            return NoAnswer(
                Reason.SHUTDOWN,
                f"This program closed its connection before {title(self.place)} had answered. Robots stop the motions of a "
                "closed connection.",
            )
        if limit_s is None and not zbus.is_listening(bus.endpoint):
            return self._no_router()
        answers = limit_s is None or bus.router_answers(ROUTER_S)
        if answers and (heard or limit_s is not None):
            time.sleep(NOTICE_S)
        if self._lost():
            return self._interrupted() if zbus.is_listening(bus.endpoint) else self._no_router()
        return None if answers else NoAnswer(Reason.NO_ROUTER, zbus.hanging_router(bus.endpoint))

    def _lost(self) -> bool:
        """Return whether the connection is lost now, or was lost since the query was sent."""
        return not self.client.bus.connected or self.client.losses != self.losses

    def _no_router(self) -> NoAnswer:
        return NoAnswer(
            Reason.NO_ROUTER,
            f"The router at {self.client.bus.endpoint} is lost, so the robots stop their motions. When the router is "
            "back, send the request again.",
        )

    def _interrupted(self) -> NoAnswer:
        """Return the error of a lost connection to a router that is still running."""
        bus = self.client.bus
        deadline_s = time.monotonic() + BACK_S
        while not bus.connected:
            if time.monotonic() > deadline_s:
                return self._not_back()
            time.sleep(POLL_S)
        return NoAnswer(
            Reason.NO_ROUTER,
            f"The connection to the router at {bus.endpoint} was lost although the router is running: this program was "
            "suspended or very busy, or the network was interrupted. Robots stop the motions of a lost connection. "
            "This program reconnects by itself: send the request again.",
        )

    def _not_back(self) -> NoAnswer:
        """Return the error of a connection that is not restored: a restarted router may have other accounts."""
        bus = self.client.bus
        error = None if self.client.settings.account is None else bus.connection_error()
        return error or NoAnswer(Reason.NO_ROUTER, zbus.hanging_router(bus.endpoint))

    # -- the robot ----------------------------------------------------------------------------------

    def _lost_node(self, *, back: bool = False) -> NoAnswer:
        """Return the error of a node that received the query and did not answer; `back`: it is online again."""
        name = title(self.place)
        return NoAnswer(Reason.NODE_LOST, detail=Detail(field=name, known=[name] if back else []))

    def _refused(self) -> NoAnswer:
        """Return the error of a query that ended without a reply although the robot is online."""
        account = self.client.settings.account
        if account is not None and self._reads_clock():
            detail = Detail(field=title(self.place), holder=account.name)
            return NoAnswer(Reason.ACCESS_DENIED, detail=detail)
        name = title(self.place)
        return NoAnswer(Reason.NO_ANSWER, detail=Detail(field=name, known=[name]))

    def _reads_clock(self) -> bool:
        """Return whether the robot answers a query that every account may send."""
        query = self.client.bus.query(keys.clock(*self.place), timeout_s=CLOCK_S)
        try:
            return query.next(CLOCK_S) is not None
        except TimeoutError:
            return False
        finally:
            query.close()

    def _late(self, limit_s: float) -> NoAnswer:
        publishes = publishing(self.client.bus, [self.place])
        detail = Detail(field=title(self.place), value=limit_s, unit="s")
        return NoAnswer(Reason.TIMED_OUT if publishes else Reason.NODE_HANGS, detail=detail)


def publishing(bus: Bus, places: Collection[Place]) -> set[Place]:
    """Return those of the robots that publish positions; waits POSITIONS_S if one of them does not."""
    topics = {keys.positions(*place): place for place in places}
    found: set[Place] = set()
    everyone = threading.Event()

    def receive(received: Received) -> None:
        found.add(topics[received.key])
        if len(found) == len(topics):
            everyone.set()

    subscriptions = [bus.subscribe(topic, receive) for topic in topics]
    everyone.wait(POSITIONS_S)
    for end in subscriptions:
        end()
    return found


def title(place: Place) -> str:
    """Return name and side in the form for users: `bea1 (hw)`."""
    return f"{place[0]} ({place[1]})"


def absent_reason(name: str, present: Collection[Place]) -> Reason:
    """Return NO_SUCH_ROBOT if only robots of other names are online; NO_ANSWER if none is, or only the other side."""
    other = present and all(robot != name for robot, _ in present)
    return Reason.NO_SUCH_ROBOT if other else Reason.NO_ANSWER


def absence(client: Client, place: Place, present: Collection[Place]) -> NoAnswer:
    """Return the error of a robot that is not online, with the robots that are."""
    reason, account = absent_reason(place[0], present), client.settings.account
    holder = "" if account is None or account.may_serve(place[0]) else account.name
    detail = Detail(field=title(place), known=[title(other) for other in present], holder=holder)
    return NoAnswer(
        reason, f"{sentences.render(reason, detail)} The router is {client.bus.endpoint}.", detail
    )
