"""Gestures that seats give to their class; the class's router keeps them."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Collection

from beatrix_zenoh.client.lesson_reports import kept
from beatrix_zenoh.client.own_gestures import LONGEST, possible
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason, SharedGesture
from beatrix_zenoh.contract.errors import NoAnswer, wrong_usage
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.contract.printable import ITEMS

ANSWER_S = 3.0
"""Time limit (s) of the router."""


def share(client: Client, name: str, text: str) -> None:
    """Give a gesture to the class, in place of an earlier one of this name.

    Raises:
        WrongUsage: BAD_VALUE, it is too long for a message.
        NoAnswer: the router is lost.
    """
    lines = text.splitlines()
    if len(lines) > ITEMS:
        raise wrong_usage(
            f"{name} has {len(lines)} lines; at most {ITEMS} can be shared. Share a shorter one."
        )
    slot = hashlib.sha256(name.encode()).hexdigest()[:16]
    gesture = SharedGesture(name=name, lines=lines)
    client.bus.put(keys.gesture(client.settings.who, slot), codec.encode(gesture), codec.MSGPACK)
    if not client.bus.router_answers(ANSWER_S):
        text = f"The router at {client.bus.endpoint} does not answer, so the class may not have {name}. Share it again."
        raise client.bus.refusal() or NoAnswer(Reason.TIMED_OUT, text)


def shared(client: Client) -> dict[str, str]:
    """Return what the teacher has shared, text by name; for the teacher what the seats have, with the seat in the name.

    Raises NoAnswer as `kept`.
    """
    teacher = client.settings.who == TEACHER
    found = kept(client, keys.gesture("*" if teacher else TEACHER, "*"), SharedGesture, ANSWER_S)
    gestures: dict[str, str] = {}
    for seat, _, gesture in found:
        if not teacher or seat != TEACHER:
            name = unused(f"{seat}-{gesture.name}", gestures) if teacher else gesture.name
            gestures[name] = "\n".join((*gesture.lines, ""))
    return {name: text for name, text in gestures.items() if possible(name)}


def unused(name: str, others: Collection[str]) -> str:
    """Return a name, shortened to what a gesture may have; with a number at its end if that is one of the others."""
    ends = itertools.chain([""], (f"-{number}" for number in itertools.count(2)))
    names = (f"{name[: LONGEST - len(end)].rstrip()}{end}" for end in ends)
    return next(one for one in names if one not in others)
