"""State queries: the newest positions, status and events, info and clock, and the description of the program.

Queries for keys that the robot does not have get an error reply.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Incoming, Sessions
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, ErrorReply
from beatrix_zenoh.contract.errors import quoted
from beatrix_zenoh.node.component import Component
from beatrix_zenoh.node.context import Context

SIMILAR = 3
"""Largest number of similar keys that a sentence names."""
CACHED_KEYS = 256


class UnknownKeys:
    """Decides which keys below `beatrix/<robot>/<side>/` the robot does not have; any thread may call its methods."""

    def __init__(self, robot: str, side: str) -> None:
        self.base = f"beatrix/{robot}/{side}/"
        fields = dict.fromkeys(("who", "arm", "eye", "session"), "*")
        rows = [row for row in keys.KEYS.values() if side in row.sides]
        found = {row.key.format_map({**fields, "robot": robot, "side": side}): row.kind for row in rows}
        self._known = {key: kind for key, kind in found.items() if key.startswith(self.base)}
        self.has = lru_cache(CACHED_KEYS)(self._has)
        """Returns whether a key is one of the robot's, or has a wildcard; only other keys get the error reply."""

    def _has(self, key: str) -> bool:
        return "*" in key or any(zbus.intersects(known, key) for known in self._known)

    def error(self, key: str) -> ErrorReply:
        """Return the error reply to a query for a key that the robot does not have."""
        queries = [known for known, kind in self._known.items() if "query" in kind]
        candidates = [self._filled(known, key) for known in queries]
        similar = difflib.get_close_matches(key.removeprefix(self.base), candidates, SIMILAR)
        names = " or ".join(f"{self.base}{name}" for name in similar)
        refusal = refusals.bad_field(
            key,
            f"This robot has no key {quoted(key)}. {f'Similar: {names}. ' if names else ''}{self.base}info lists all.",
            [known.replace("*", "<who>") for known in queries],
        )
        detail = refusal.detail or Detail()
        return ErrorReply(result=False, reason=refusal.reason, message=refusal.message, detail=detail)

    def _filled(self, known: str, key: str) -> str:
        """Return a known key without its beginning, with the chunks of `key` in place of its wildcards."""
        given = key.split("/")
        chunks = [
            chunk if chunk != "*" else given[place] if place < len(given) else "me"
            for place, chunk in enumerate(known.split("/"))
        ]
        return "/".join(chunks).removeprefix(self.base)


REST = {"control": ("*", "*/*", "*/*/*/*/**"), "motion": ("*/*/*",)}
"""Key expressions below the robot's own that receive the queries for unknown keys, by traffic class. They also receive
the queries for known keys, so STOP and motions must find them in their own session: another would cost 0.15 ms."""


class StateQueries(Component):
    """Answers state queries on a thread of its own."""

    def __init__(self, context: Context) -> None:
        name, side, snapshot = context.name, context.side, context.snapshot
        self._answers: dict[str, Callable[[], msgspec.Struct]] = {
            keys.positions(name, side): snapshot.positions,
            keys.positions_json(name, side): snapshot.positions,
            keys.status(name, side): snapshot.status,
            keys.status_json(name, side): snapshot.status,
            keys.events(name, side): context.events.latest,
            keys.events_json(name, side): context.events.latest,
            keys.info(name, side): snapshot.info,
            keys.clock(name, side): snapshot.clock,
        }
        self._name, self._side = name, side
        self._unknown = UnknownKeys(name, side)
        self._worker: ThreadPoolExecutor | None = None

    def start(self, sessions: Sessions) -> None:
        self._worker = ThreadPoolExecutor(1, "beatrix-queries")
        self._worker.submit(lambda: None).result()
        description = keys.program(self._name, sessions.control.session_id)
        self._answers[description] = lambda: sessions.describe(self._side)
        for key in self._answers:
            sessions.serve(key, lambda incoming, key=key: self._query(incoming, key))  # type: ignore[misc]
        for traffic, expressions in REST.items():
            for expression in expressions:
                sessions.session(traffic).serve_rest(f"{self._unknown.base}{expression}", self._rest)

    def _query(self, incoming: Incoming, key: str) -> None:
        """Pass a query from Zenoh's thread to the worker's thread."""
        try:
            if self._worker is not None:
                self._worker.submit(self._answer, incoming, key)
        except RuntimeError:  # the worker is closed: answer on this thread
            self._answer(incoming, key)

    def _answer(self, incoming: Incoming, key: str) -> None:
        incoming.reply(key, *incoming.raw.answer(self._answers[key]()))
        incoming.finish()

    def _rest(self, incoming: Incoming) -> None:
        """Pass a query for an unknown key from Zenoh's thread to the worker's thread; drop all others."""
        if self._worker is None or self._unknown.has(incoming.key):
            incoming.finish()
            return
        try:
            self._worker.submit(self._refuse, incoming)
        except RuntimeError:  # the worker is closed
            incoming.finish()

    def _refuse(self, incoming: Incoming) -> None:
        incoming.reply_error(*incoming.raw.answer(self._unknown.error(incoming.key)))
        incoming.finish()

    def close(self) -> None:
        """Answer the waiting queries, then end the thread."""
        if self._worker is not None:
            self._worker.shutdown()
