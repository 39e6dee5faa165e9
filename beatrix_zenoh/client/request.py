"""Queries to one robot or to many.

A query reaches every matching queryable, also those of foreign programs, so only replies on the robot's own key count.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

import msgspec

from beatrix_zenoh.bus import Query, Reply
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.silence import Unanswered
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import CommandReply, Info, MotionReply
from beatrix_zenoh.contract.errors import NoAnswer

STALE_S = 0.02
"""Time (s) after the restart of a node in which queries of an open session may reach no queryable (zenoh#2767)."""
LATE_S = 2.0
"""Extra lifetime (s) of a query after its caller's time limit: a motion that is accepted late must be stopped."""
LOSS_CHECK_S = 0.5
"""Period (s) of the check for a lost router: Zenoh does not end a query sent just before it notices the loss."""
M = TypeVar("M", bound=msgspec.Struct)


def own_place(asked: str, answered: str) -> Place | None:
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
    place = own_place(asked, answer.key)
    if place is None:
        client.report(answer, f"ignored: a foreign reply to {asked}, not on the robot's own key.")
        return None
    message = client.read(answer, kind)
    return None if message is None else (place, message)


class Request:
    """One query to one robot and its replies; it is repeated once if it ends without a reply."""

    def __init__(
        self,
        client: Client,
        place: Place,
        key: str,
        request: msgspec.Struct | None,
        lasts_s: float,
        priority: str | None = None,
    ) -> None:
        """Send the query, by default with the priority of its key; replies are received for `lasts_s` and 2 s more."""
        self._client, self._place, self._key, self._priority = client, place, key, priority
        self._payload = None if request is None else codec.encode(request)
        self._lasts_s = lasts_s + LATE_S
        self._unanswered = Unanswered(client, place, client.losses)
        self._heard = self._repeated = False
        self._query = self._ask()

    def _ask(self) -> Query:
        return self._client.bus.query(self._key, self._payload, codec.MSGPACK, self._priority, self._lasts_s)

    def next(self, kind: type[M], timeout_s: float) -> M:
        """Return the robot's next reply; wait for it up to `timeout_s` (s).

        Raises:
            NoAnswer: the reason that `silence` finds, or SHUTDOWN if this program has closed the client.
        """
        try:
            return self.reply(kind, timeout_s)
        except TimeoutError:
            raise self.explain(timeout_s) from None

    def explain(self, limit_s: float) -> NoAnswer:
        """Return the error of a reply that did not come within `limit_s`; takes up to 3 s."""
        return self._unanswered.explain(limit_s, heard=self._heard)

    def reply(self, kind: type[M], timeout_s: float) -> M:
        """Return the result of `next`, but raise TimeoutError if no reply arrives within `timeout_s`."""
        deadline = time.monotonic() + timeout_s
        while True:
            answer = self._next(deadline)
            if answer is None and not (self._heard or self._repeated or self._client.bus.closed):
                answer = self._again(deadline)
            if answer is None:
                raise self._unanswered.explain(heard=self._heard)
            reply = _read(self._client, self._key, answer, kind)
            if reply is not None:
                self._heard = True
                self._client.seen.add(self._place)
                if isinstance(reply[1], MotionReply | CommandReply):
                    self._client.replied_s[self._place] = time.monotonic()
                return reply[1]

    def _again(self, deadline: float) -> Reply | None:
        """Repeat the query and return its first reply: just after a node's restart the first query may be lost."""
        self._repeated = True
        time.sleep(STALE_S)
        self._query.close()
        self._query = self._ask()
        return self._next(deadline)

    def _next(self, deadline: float) -> Reply | None:
        """Return the next reply, None at the end of the query; raises NoAnswer after a loss of the router."""
        while True:
            left_s = deadline - time.monotonic()
            try:
                return self._query.next(min(left_s, LOSS_CHECK_S))
            except TimeoutError:
                if left_s <= LOSS_CHECK_S:
                    raise
                if self._client.losses != self._unanswered.losses:
                    raise self._unanswered.explain(heard=self._heard) from None

    def notify(self, notify: Callable[[], None]) -> None:
        """Call `notify` on Zenoh's thread after every reply; it must not block."""
        self._query.notify(notify)

    def if_accepted(self, do: Callable[[], None]) -> None:
        """End the wait for this motion; if the robot accepts it late, call `do`, which must not block."""

        def read(answer: Reply) -> None:
            reply = _read(self._client, self._key, answer, MotionReply)
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
    ) -> None:
        """Send the query; replies are received for `lasts_s` and 2 s more."""
        self._client, self._key, self._kind = client, key, kind
        payload = None if request is None else codec.encode(request)
        self._query = client.bus.query(key, payload, codec.MSGPACK, priority, lasts_s + LATE_S)

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
    client: Client, place: Place, key: str, request: msgspec.Struct | None, kind: type[M], timeout_s: float
) -> M:
    """Query one robot and return its reply.

    Raises:
        NoAnswer: the reason that `silence` finds; if the robot is not online, the message names those that are.
        WrongUsage: SHUTDOWN, the client was closed.
    """
    query = Request(client, place, key, request, timeout_s)
    try:
        return query.next(kind, timeout_s)
    finally:
        query.close()


def infos(client: Client, timeout_s: float = 1.0) -> dict[Place, Info]:
    """Return the info of every robot that answers within `timeout_s` (s)."""
    return dict(GroupRequest(client, keys.info("*", "*"), None, Info, timeout_s).replies(timeout_s))
