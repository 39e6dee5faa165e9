"""The decisions of the teacher that robots of the class do not have yet, because they were not online (decision 122).

The process of `beatrix router --class` keeps them in a file beside the router file, and sends each to its robot when
that comes. They have no times: of each kind only the newest is kept, and all are sent on one thread.
"""

from __future__ import annotations

import math
import queue
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files, threads
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction, LeaseQuery, LeaseReply, Reason
from beatrix_zenoh.contract.errors import BeatrixError, WrongUsage
from beatrix_zenoh.output import note

LONGEST: Final = 1 << 20
"""Largest size of the file (bytes)."""
ANSWER_S, AGAIN_S = 1.0, 1.0
"""Time limit (s) of a robot's reply, and period of the attempts while a robot is online and does not answer."""
ENDS: Final = {LeaseAction.UNFREEZE: LeaseAction.FREEZE, LeaseAction.UNMUTE: LeaseAction.MUTE}
Kept = dict[str, dict[str, LeaseQuery]]
"""By key of a robot, and by kind."""


def decide(kept: Kept, key: str, query: LeaseQuery, *, online: bool) -> None:
    """Keep a decision in place of an earlier one of its kind; the teacher's program sends it to a robot that is online.

    An online robot that did not take the earlier one gets the new one here, too: the earlier one may still arrive.
    """
    kind = f"{ENDS.get(query.action, query.action)} {query.seat}"
    if online and kind not in kept.get(key, {}):
        return
    kept[key] = {**{one: other for one, other in kept.get(key, {}).items() if one != kind}, kind: query}


def words(query: LeaseQuery) -> str:
    """Return a decision as the teacher types it: `mute cem`, `limit 20`."""
    match query.action:
        case LeaseAction.LIMIT:
            return f"limit {math.degrees(query.speed):.4g}" if query.speed else "limit off"
        case LeaseAction.TURN:
            return f"limit --turn {query.longest_s:g}" if query.longest_s else "limit --turn off"
    return f"{query.action} {query.seat}".strip()


class PendingDecisions:
    """Keeps decisions for robots and sends them; the access rules see to it that only the teacher adds and reads them."""

    def __init__(self, bus: zbus.Bus, place: Path, robots: Callable[[], Collection[str]]) -> None:
        """Serve until `bus` is closed, with the decisions in the file at `place`; `robots` returns those of the class."""
        self._bus, self._place, self._robots = bus, place, robots
        self._events: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._online: set[str] = set()
        self._kept: Kept = {}
        try:
            if place.exists():
                self._kept = msgspec.json.decode(files.content(place, LONGEST, "JSON"), type=Kept)
        except (OSError, WrongUsage, *codec.UNREADABLE) as error:
            note(
                f"The decisions for robots that are not online are lost, because {place} cannot be read: {error}"
            )
        bus.watch_tokens(
            keys.alive("*", "*"), lambda key, alive: self._events.put(lambda: self._seen(key, alive=alive))
        )
        bus.serve(keys.pending("*", "*"), lambda incoming: self._events.put(lambda: self._answer(incoming)))
        threads.start(self._work, "pending")

    def _work(self) -> None:
        """Handle events one after another, so that a robot gets an earlier decision before the teacher decides again."""
        while not self._bus.closed:
            try:
                with suppress(queue.Empty):
                    self._events.get(timeout=AGAIN_S)()
                for key in [key for key in self._kept if key in self._online]:
                    self._deliver(key)
            except WrongUsage:
                return  # closed meanwhile
            except Exception as error:  # noqa: BLE001 # the next decision must still be kept
                threads.show_error(error)

    def _seen(self, token: str, *, alive: bool) -> None:
        if (parts := keys.parse(token)) is not None:
            (self._online.add if alive else self._online.discard)(keys.pending(parts.robot, parts.side))

    def _answer(self, incoming: zbus.Incoming) -> None:
        """Add the decision of a query for the robots that match its key; reply with what is kept for those not online."""
        own = [[keys.pending(robot, side) for side in names.SIDES] for robot in self._robots()]
        asked = [key for sides in own for key in sides if zbus.intersects(key, incoming.key)]
        online = {key for sides in own if self._online.intersection(sides) for key in sides}
        try:
            if payload := incoming.raw.payload:
                query = codec.decode(payload, LeaseQuery)
                for key in asked:
                    decide(self._kept, key, query, online=key in self._online)
                self._write()
            for key in asked:
                if key not in online and (kept := self._kept.get(key)):
                    text = ", ".join(map(words, kept.values()))
                    reply = LeaseReply(
                        result=True, reason=Reason.OK, message=text, lease=0, holder="", waiting=[]
                    )
                    incoming.reply(key, codec.encode(reply), codec.MSGPACK)
        except BeatrixError as error:
            incoming.reply_error(error.message.encode(), "text/plain")
        finally:
            incoming.finish()

    def _deliver(self, key: str) -> None:
        """Send a robot what is kept for it, and forget each decision that it has answered, whether or not it obeys."""
        parts = keys.parse(key)
        assert parts is not None
        lease = keys.lease(parts.robot, parts.side, names.TEACHER)
        for kind, decision in [*self._kept[key].items()]:
            query = self._bus.query(lease, codec.encode_request(decision), codec.MSGPACK, timeout_s=ANSWER_S)
            if not query.is_answered(ANSWER_S):
                return
            del self._kept[key][kind]
            self._write()
        del self._kept[key]

    def _write(self) -> None:
        try:
            files.write_private(self._place, msgspec.json.encode(self._kept).decode())
        except OSError as error:
            note(
                f"The decisions for robots that are not online cannot be stored ({error}): after the next start of this "
                "program the routers apply those that were stored last."
            )
