"""`beatrix graph`: the programs that are connected to a router, and their keys.

The router answers nothing about itself (decision 41). Liveliness tokens show which nodes and seats are there, and each
program describes itself; a Zenoh program without both stays unseen.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import ProgramInfo
from beatrix_zenoh.output import print_json, say
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Json, Who

ANSWER_S: Final = 2.0
"""How long (s) to wait for the descriptions; programs that hang are then listed without keys."""
DECLARED = ("serves", "publishes", "subscribes", "asks")
"""Sets of keys of a program."""
UNDESCRIBED = "does not describe itself: it hangs, or has another version"

Owner = tuple[str, str]
"""Robot and side of a node; seat and session of a client."""


def graph(connect: Connect = None, who: Who = None, as_json: Json = False) -> None:
    """Show the programs at the router, and which watch or ask which.

    Requests count for one minute. Programs describe themselves. A Zenoh program that does not use this library is not listed.
    """
    with Client(resolve(None, connect, who)) as client:
        programs, endpoint = read(client), client.bus.endpoint
    if as_json:
        print_json(
            {"result": True, "endpoint": endpoint, "programs": [as_row(program) for program in programs]}
        )
    else:
        say(text(programs, endpoint))


def as_row(program: ProgramAtRouter) -> dict[str, object]:
    """Return the fields of a program, for JSON output."""
    return {
        "title": program.title,
        "described": program.described is not None,
        **{name: program.keys_of(name) for name in DECLARED},
    }


def lines(program: ProgramAtRouter, nodes: Sequence[ProgramAtRouter]) -> list[str]:
    """Return a line for each key that a node publishes or serves, or for each node that a client watches or asks."""
    if program.described is None:
        return [UNDESCRIBED]
    if program.robot is not None:
        published = [short(key) for key in program.keys_of("publishes")]
        answered = sorted({short(key) for key in program.keys_of("serves")} - {*published})
        return [*(f"publishes {key}" for key in published), *(f"answers {key}" for key in answered)]
    rows = [f"watches {node.title}: {', '.join(found)}" for node in nodes if (found := program.watches(node))]
    rows += [f"asks {node.title}: {', '.join(found)}" for node in nodes if (found := program.queries(node))]
    return rows or ["watches and asks no robot"]


def text(programs: Sequence[ProgramAtRouter], endpoint: str) -> str:
    """Return a text for a terminal: all programs, with their keys."""
    nodes = [program for program in programs if program.robot is not None]
    listed = ("\n  ".join([program.title, *lines(program, nodes)]) for program in programs)
    return "\n\n".join([f"router {endpoint}", *listed])


class ProgramAtRouter(NamedTuple):
    """A program at the router: a node or a client."""

    title: str
    robot: Place | None
    """name and side, if it is a node"""
    described: ProgramInfo | None
    """None: it hangs or has another version, and its keys are unknown"""

    def keys_of(self, kind: str) -> list[str]:
        """Return the keys of one kind of DECLARED."""
        found: list[str] = getattr(self.described, kind, [])
        return found

    def watches(self, node: ProgramAtRouter) -> list[str]:
        """Return the publications of a node that this program subscribes to, such as `state/positions`; sorted."""
        watched = self.keys_of("subscribes")
        return sorted({short(key) for key in node.keys_of("publishes") if _any_matches(watched, key)})

    def queries(self, node: ProgramAtRouter) -> list[str]:
        """Return the purposes of the queries and puts that this program has lately sent to a node; sorted."""
        answered = [*node.keys_of("serves"), *node.keys_of("subscribes")]
        return sorted({_purpose(key) for key in self.keys_of("asks") if _any_matches(answered, key)})


def read(client: Client) -> list[ProgramAtRouter]:
    """Return all programs at the client's router but this one: first the nodes, then the clients, sorted by title.

    Raises NoAnswer (ACCOUNT_REFUSED) as `Client.robots`.
    """
    client.robots()
    infos, (nodes, seats) = _descriptions(client), _tokens(client)
    if not infos.keys() >= nodes | seats:  # a program has joined meanwhile, or hangs
        infos, (nodes, seats) = _descriptions(client), _tokens(client)
    programs = []
    for owner in sorted({*infos, *nodes, *seats} - {(client.settings.who, client.bus.session_id)}):
        node = owner[1] in names.SIDES
        if node and owner not in nodes:
            continue  # a description without the token of its robot: the node starts or ends
        for info in infos.get(owner, [None]):
            title = "{} ({})".format(*owner) if node else _title(owner[0], info)
            programs.append(ProgramAtRouter(title, owner if node else None, info))
    return sorted(programs, key=lambda program: (program.robot is None, program.title))


def _title(seat: str, info: ProgramInfo | None) -> str:
    return f"seat {seat}" if info is None else f"seat {seat}: {info.program}"


def _descriptions(client: Client) -> dict[Owner, list[ProgramInfo]]:
    """Return the descriptions that arrive within ANSWER_S; several nodes of one robot may describe themselves."""
    found: dict[Owner, list[ProgramInfo]] = {}
    query = client.bus.query(keys.program("*", "*"), None, codec.MSGPACK, timeout_s=ANSWER_S)
    for reply in query.replies(ANSWER_S):
        # An error reply is that of a program which leaves before it answers.
        parts = None if reply.error else keys.parse(reply.key)
        info = None if parts is None else client.read(reply, ProgramInfo)
        if parts is not None and info is not None:
            second = info.side if info.side in names.SIDES else parts.session
            found.setdefault((parts.who, second), []).append(info)
    return found


def _tokens(client: Client) -> tuple[set[Owner], set[Owner]]:
    """Return the nodes and the clients that have announced themselves."""
    nodes, seats = (
        map(keys.parse, client.bus.tokens(key)) for key in (keys.alive("*", "*"), keys.seat("*", "*"))
    )
    return (
        {(parts.robot, parts.side) for parts in nodes if parts is not None},
        {(parts.who, parts.session) for parts in seats if parts is not None},
    )


def _any_matches(expressions: Iterable[str], key: str) -> bool:
    return any(zbus.intersects(expression, key) for expression in expressions)


def _purpose(key: str) -> str:
    """Return the name of a key's row, such as `motion`, or else the key without robot and side."""
    parts = keys.parse(key)
    return short(key) if parts is None else parts.row


def short(key: str) -> str:
    """Return a key without `beatrix`, robot and side: `state/positions`."""
    return "/".join(key.split("/")[3:]) or key
