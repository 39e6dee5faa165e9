"""The programs at a router, and the keys that they serve, publish and subscribe to, from the router's records."""

from __future__ import annotations

import contextlib
import re
import time
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Final

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.errors import NoAnswer

RECORDS: Final = re.compile(r"@/[0-9a-f]+/router/(subscriber|queryable|publisher)/(.+)")
"""Keys of the router's admin space; the groups are the kind of a declaration and its key expression."""
FIELDS: Final = {"queryable": "serves", "publisher": "publishes", "subscriber": "subscribes"}
"""The field of a program for each kind of declaration."""
ANSWER_S: Final = 2.0


class Sources(msgspec.Struct):
    """A record of the admin space: the sessions that have declared a key expression."""

    clients: list[str] = []


@dataclass
class Program:
    """A program at the router: a node, a seat, or a program of which only the session is known."""

    title: str
    robot: tuple[str, str] | None = None
    """name and twin, if it is a node"""
    serves: set[str] = field(default_factory=set)
    publishes: set[str] = field(default_factory=set)
    subscribes: set[str] = field(default_factory=set)

    def watches(self, node: Program) -> list[str]:
        """Return the publications of a node that this program subscribes to, such as `state/positions`; sorted."""
        return sorted(
            {
                short(published)
                for published in node.publishes
                if any(zbus.intersects(subscribed, published) for subscribed in self.subscribes)
            }
        )


def read(client: Client) -> list[Program]:
    """Return all programs at the client's router: first the nodes, then the others, both sorted by title.

    Raises:
        NoAnswer: ACCESS_DENIED, the router does not let this seat read its admin space.
    """
    declared = _declarations(client)
    if declared is None:
        raise NoAnswer(
            Reason.ACCESS_DENIED,
            f"The router at {client.bus.endpoint} does not let this seat list its programs. In a class only the seat `teacher` may.",
        )
    seats = _seats(client)
    programs: dict[str, Program] = {}
    for session, kind, key in sorted(
        (session, kind, key) for kind, found in declared.items() for session, key in found
    ):
        parts = keys.parse(key)
        programs.setdefault(session, Program(seats.get(session, f"program {session[:8]}")))
        program = programs[session]
        if kind != "subscriber" and parts is not None and "*" not in (parts.robot or "*"):
            program.robot = parts.robot, parts.twin
        getattr(program, FIELDS[kind]).add(key)
    for session, title in seats.items():
        programs.setdefault(session, Program(title))
    return _merged(list(programs.values()))


def _declarations(client: Client) -> dict[str, list[tuple[str, str]]] | None:
    """Return session and key expression of every declaration, by kind; None if the router does not reply."""
    answered = False
    found: dict[str, list[tuple[str, str]]] = defaultdict(list)
    query = client.bus.query("@/*/router/**", None, None)
    deadline_s = time.monotonic() + ANSWER_S
    try:
        with contextlib.suppress(TimeoutError):
            while (reply := query.next(deadline_s - time.monotonic())) is not None:
                answered = True
                record = RECORDS.fullmatch(reply.key)
                if record is None:
                    continue
                sources = msgspec.json.decode(reply.payload, type=Sources)
                found[record[1]] += [(session, record[2]) for session in sources.clients]
    finally:
        query.close()
    return found if answered else None


def _seats(client: Client) -> dict[str, str]:
    """Return the title of each announced seat by its session, except the session of this client."""
    found = map(keys.parse, client.bus.tokens(keys.seat("*", "*")))
    return {
        parts.session: f"seat {parts.who}"
        for parts in found
        if parts is not None and parts.session != client.bus.session_id
    }


def _merged(programs: list[Program]) -> list[Program]:
    """Merge all sessions of a node into one program, and likewise all sessions of a seat; return them sorted."""
    merged: dict[str, Program] = {}
    for program in programs:
        title = program.title if program.robot is None else "{} ({})".format(*program.robot)
        whole = merged.setdefault(title, Program(title, program.robot))
        whole.serves |= program.serves
        whole.publishes |= program.publishes
        whole.subscribes |= program.subscribes
    return sorted(merged.values(), key=lambda program: (program.robot is None, program.title))


def short(key: str) -> str:
    """Return a key without `beatrix`, robot and twin: `state/positions`."""
    return "/".join(key.split("/")[3:]) or key
