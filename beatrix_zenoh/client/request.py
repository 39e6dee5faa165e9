"""Queries to robots, and the cause of a missing answer.

A query reaches every matching queryable, also those of foreign programs, so only replies on the robot's own key count.

Zenoh 1.10 does not report why an answer is missing: a query ends without a reply if the robot is absent or has crashed,
and also if the access rules of the router refuse it. `SentQuery` finds the cause from the connection, the liveliness
tokens and the robot's publications. That takes up to 3 s, so it runs only after a query has failed.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Iterator
from functools import lru_cache
from typing import Generic, TypeVar

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Bus, Query, Received, Reply
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract import codec, sentences
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, Info, MotionReply, Outcome, Reason
from beatrix_zenoh.contract.errors import NoAnswer, Refused

NOTICE_S = 0.2
"""Time (s) to wait for the report of a loss: Zenoh ends the queries of a lost connection before it reports the loss."""
BACK_S = 0.6
"""Zenoh restores a lost connection within this time (s) if the router answers."""
RETURN_S = 10.0
"""Time (s) after the loss or the return of a router in which its robots may be absent, or their requests refused: they
reconnect, and so does a class's second router."""
POLL_S = 0.02
"""Period (s) in which a restored connection is looked for."""
ABSENT_S = 1.5
"""A query that reaches no node ends within this time (s). If one ends later without a reply, its node has ended."""
POSITIONS_S = 1.0
"""A node that publishes no positions for this long (s) counts as NODE_HANGS; it publishes them every 20 ms."""
CLOCK_S = 1.0
"""Time limit (s) of the query for the clock, which every account may send."""
STALE_S = (0.02, 0.1, 0.5)
"""Pauses (s) before a query that ended without a reply is repeated: just after the restart of a node, or beside a flood
that has ended on a busy computer, a query of an open session may reach no queryable (zenoh#2767)."""
LATE_S = 2.0
"""Extra lifetime (s) of a query after its caller's time limit: a motion that is accepted late must be stopped."""
LOSS_CHECK_S = 0.5
"""Period (s) of the check for a lost router: Zenoh does not end a query sent just before it notices the loss."""
M = TypeVar("M", bound=msgspec.Struct)
A = TypeVar("A", bound=Outcome)


class SentQuery:
    """A query that was sent to one robot, and the cause of a missing answer."""

    def __init__(self, client: Client, place: Place) -> None:
        """Create this just before the query is sent."""
        self.client, self.place = client, place
        self.losses, self.began_s = client.losses, time.monotonic()
        self.heard = False
        """Whether the query had a reply."""

    def explain(self, limit_s: float | None = None) -> NoAnswer:
        """Return the error of a query without a reply: within `limit_s` (s) or, with None, until the query ended.

        Takes up to 3 s.
        """
        waited_s = time.monotonic() - self.began_s
        error = self._disconnected(limit_s)
        if error is not None:
            return error
        try:
            present = self.client.robots()
        except NoAnswer as refused:
            return refused
        if self._lost():
            return self._interrupted()
        received = self.heard or waited_s > ABSENT_S
        if self.place not in present:
            return self._absent(present, received=received)
        if limit_s is not None:
            reason = Reason.TIMED_OUT if publishing(self.client.bus, [self.place]) else Reason.NODE_HANGS
            return NoAnswer(reason, detail=Detail(field=title(self.place), value=limit_s, unit="s"))
        return self._lost_node(back=True) if received else self._refused()

    # -- the router ---------------------------------------------------------------------------------

    def _disconnected(self, limit_s: float | None) -> NoAnswer | None:
        """Return the error of a closed or lost connection, or of a lost or unresponsive router; otherwise None."""
        bus = self.client.bus
        if bus.closed:
            return NoAnswer(
                Reason.SHUTDOWN,
                f"This program closed its connection before {title(self.place)} had answered. Robots stop the motions of a "
                "closed connection.",
            )
        answers = zbus.is_listening(bus.endpoint) if limit_s is None else bus.router_answers()
        if answers and (self.heard or limit_s is not None):
            time.sleep(NOTICE_S)
        if self._lost() or (limit_s is None and not answers):
            return self._interrupted()
        return None if answers else NoAnswer(Reason.NO_ROUTER, zbus.hanging_router(bus.endpoint))

    def _lost(self) -> bool:
        """Return whether the connection is lost now, or was lost since the query was sent."""
        return not self.client.bus.connected or self.client.losses != self.losses

    def _returning(self) -> bool:
        """Return whether routers and robots may still be reconnecting after a loss."""
        return time.monotonic() - self.client.lost_s < RETURN_S

    def _interrupted(self) -> NoAnswer:
        """Return the error of a lost router, or of a lost connection to one that is running."""
        bus = self.client.bus
        if not zbus.is_listening(bus.endpoint):
            text = (
                f"The router at {bus.endpoint} is lost, so the robots stop their motions. When the router is back, send "
                "the request again."
            )
            return NoAnswer(Reason.NO_ROUTER, text)
        deadline_s = time.monotonic() + BACK_S
        while not bus.connected:
            if time.monotonic() > deadline_s:  # a restarted router may have other accounts
                error = None if self.client.settings.account is None else bus.connection_error()
                return error or NoAnswer(Reason.NO_ROUTER, zbus.hanging_router(bus.endpoint))
            time.sleep(POLL_S)
        return bus.refusal() or NoAnswer(
            Reason.NO_ROUTER,
            f"The connection to the router at {bus.endpoint} was lost, and a router answers there again: it was restarted, "
            "this program was suspended or very busy, or the network was interrupted. Robots stop the motions of a lost "
            "connection, and appear again within some seconds. This program reconnects by itself: send the request again.",
        )

    # -- the robot ----------------------------------------------------------------------------------

    def _absent(self, present: Collection[Place], *, received: bool) -> NoAnswer:
        """Return the error of a robot that is not online; after the loss of a router it may be on its way back."""
        if not (received or self.place in self.client.seen):
            return absence(self.client, self.place, present)
        return self._interrupted() if self._returning() else self._lost_node()

    def _lost_node(self, *, back: bool = False) -> NoAnswer:
        """Return the error of a node that received the query and did not answer; `back`: it is online again."""
        name = title(self.place)
        return NoAnswer(Reason.NODE_LOST, detail=Detail(field=name, known=[name] if back else []))

    def _refused(self) -> NoAnswer:
        """Return the error of a query that ended without a reply although the robot is online."""
        if self._returning():
            return self._interrupted()
        account = self.client.settings.account
        if account is not None and self._reads_clock():
            detail = Detail(field=title(self.place), holder=account.name)
            return NoAnswer(Reason.ACCESS_DENIED, detail=detail)
        name = title(self.place)
        return NoAnswer(Reason.NO_ANSWER, detail=Detail(field=name, known=[name]))

    def _reads_clock(self) -> bool:
        """Return whether the robot answers a query that every account may send."""
        return self.client.bus.query(keys.clock(*self.place), timeout_s=CLOCK_S).is_answered(CLOCK_S)


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


@lru_cache(maxsize=1024)
def matching_robot(asked: str, answered: str) -> Place | None:
    """Return name and side of the robot if the key of a reply is the robot's own; otherwise None."""
    want, found = keys.parse(asked), keys.parse(answered)
    if want is None or found is None or want.row != found.row or "*" in answered:
        return None
    same = all(wanted in ("*", given) for wanted, given in zip(want, found, strict=True))
    return (found.robot, found.side) if same else None


def _read(client: Client, asked: str, answer: Reply, kind: type[M]) -> tuple[Place, M] | None:
    """Decode the reply of a robot; log and return None if it is a foreign or an error reply, or unreadable."""
    if answer.error:
        client.report(answer, f"ignored: an error reply to {asked}, {answer.payload[: codec.LONGEST]!r}.")
        return None
    place = matching_robot(asked, answer.key)
    if place is None:
        client.report(answer, f"ignored: a foreign reply to {asked}, not on the robot's own key.")
        return None
    message = client.read(answer, kind)
    return None if message is None else (place, message)


class Request(SentQuery):
    """One query to one robot and its replies; it is repeated if it ends without a reply although the robot is online."""

    def __init__(
        self,
        client: Client,
        place: Place,
        key: str,
        request: msgspec.Struct | None,
        lasts_s: float,
        priority: str | None = None,
        attachment: bytes | None = None,
    ) -> None:
        """Send the query, by default with the priority of its key; replies are received for `lasts_s` and 2 s more."""
        super().__init__(client, place)
        self._key, self._priority, self._attachment = key, priority, attachment
        self._payload = None if request is None else codec.encode_request(request)
        self._lasts_s = lasts_s + LATE_S
        self._repeated = False
        self._query = self._ask()

    def _ask(self) -> Query:
        return self.client.bus.query(
            self._key, self._payload, codec.MSGPACK, self._priority, self._lasts_s, self._attachment
        )

    def next(self, kind: type[M], timeout_s: float) -> M:
        """Return the robot's next reply; wait for it up to `timeout_s` (s).

        Raises:
            NoAnswer: the reason that `explain` finds, or SHUTDOWN if this program has closed the client.
        """
        try:
            return self.reply(kind, timeout_s)
        except TimeoutError:
            raise self.explain(timeout_s) from None

    def reply(self, kind: type[M], timeout_s: float) -> M:
        """Return the result of `next`, but raise TimeoutError if no reply arrives within `timeout_s`."""
        deadline = time.monotonic() + timeout_s
        while True:
            answer = self._next(deadline)
            if answer is None and not (self.heard or self._repeated or self.client.bus.closed):
                answer = self._again(deadline)
            if answer is None:
                raise self.explain()
            reply = _read(self.client, self._key, answer, kind)
            if reply is not None:
                self.heard = True
                self.client.seen.add(self.place)
                return reply[1]

    def _again(self, deadline: float) -> Reply | None:
        """Repeat the query, for the causes of STALE_S, and return its first reply; None if it has none."""
        self._repeated = True
        for pause_s in STALE_S:
            if time.monotonic() + pause_s > deadline:
                break  # the cause of the missing replies tells more than a time limit
            time.sleep(pause_s)
            self._query.close()
            self._query = self._ask()
            answer = self._next(deadline)
            if answer is not None or not self._online():
                return answer
        return None

    def _online(self) -> bool:
        try:
            return self.place in self.client.robots()
        except NoAnswer:
            return False

    def _next(self, deadline: float) -> Reply | None:
        """Return the next reply, None at the end of the query; raises NoAnswer after a loss of the router."""
        while True:
            left_s = deadline - time.monotonic()
            try:
                return self._query.next(min(left_s, LOSS_CHECK_S))
            except TimeoutError:
                if left_s <= LOSS_CHECK_S:
                    raise
                if self.client.losses != self.losses:
                    raise self.explain() from None

    def notify(self, notify: Callable[[], None]) -> None:
        """Call `notify` on Zenoh's thread after every reply; it must not block."""
        self._query.notify(notify)

    def if_accepted(self, do: Callable[[], None]) -> None:
        """End the wait for this motion; if the robot accepts it late, call `do`, which must not block."""

        def read(answer: Reply) -> None:
            reply = _read(self.client, self._key, answer, MotionReply)
            if reply is not None and reply[1].result:
                do()

        self._query.hand_over(read)

    def close(self) -> None:
        """Receive no more replies."""
        self._query.close()


class GroupRequest(Generic[M]):
    """One query to all robots that match a key with wildcards."""

    def __init__(
        self,
        client: Client,
        key: str,
        request: msgspec.Struct | None,
        kind: type[M],
        lasts_s: float,
        priority: str | None = None,
        attachment: bytes | None = None,
    ) -> None:
        """Send the query; replies are received for `lasts_s` and 2 s more."""
        self._client, self._key, self._kind = client, key, kind
        payload = None if request is None else codec.encode_request(request)
        self._query = client.bus.query(key, payload, codec.MSGPACK, priority, lasts_s + LATE_S, attachment)

    def replies(self, timeout_s: float) -> Iterator[tuple[Place, M]]:
        """Yield name, side and reply of each robot, in the order of arrival, for at most `timeout_s` (s)."""
        for answer in self._query.replies(timeout_s):
            reply = _read(self._client, self._key, answer, self._kind)
            if reply is not None:
                yield reply

    def close(self) -> None:
        """Receive no more replies."""
        self._query.close()


def ask(
    client: Client,
    place: Place,
    key: str,
    request: msgspec.Struct | None,
    kind: type[M],
    timeout_s: float,
    attachment: bytes | None = None,
) -> M:
    """Query one robot and return its reply.

    Raises:
        NoAnswer: the reason that `SentQuery.explain` finds; if the robot is not online, the message names those that are.
        WrongUsage: SHUTDOWN, the client was closed.
    """
    query = Request(client, place, key, request, timeout_s, attachment=attachment)
    try:
        return query.next(kind, timeout_s)
    finally:
        query.close()


def outcome(reply: A) -> A | Refused:
    """Return the reply, or the error if the robot refused."""
    return reply if reply.result else Refused(reply.reason, reply.message, reply.detail)


def accepted(reply: A) -> A:
    """Return the reply; raises Refused if the robot refused."""
    if isinstance(found := outcome(reply), Refused):
        raise found
    return found


def infos(client: Client, timeout_s: float = 1.0) -> dict[Place, Info]:
    """Return the info of every robot that answers within `timeout_s` (s)."""
    return dict(GroupRequest(client, keys.info("*", "*"), None, Info, timeout_s).replies(timeout_s))
