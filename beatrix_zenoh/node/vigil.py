"""Whether the router still knows this node: each of its sessions is asked for through another."""

from __future__ import annotations

import threading
from collections.abc import Callable

from beatrix_zenoh import threads
from beatrix_zenoh._generated import keys
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.node.roads import Roads

PERIOD_S = 1.0
ANSWER_S = 1.0
DEAF = 2
"""Times in a row that nobody hears a key before its session is renewed; just after a reconnection it may be once."""
SEAT = "node-check"
"""Asks without saying what, which is refused: an answer like any other."""


class Vigil:
    """Renews a session that the router has forgotten.

    A session that was cut off in a flood can come back without its declarations (zenoh 1.10, about once in ten
    times): connected, alive, and deaf for ever. `cut` is told of it, in a sentence for people.
    """

    def __init__(self, roads: Roads, name: str, twin: str, cut: Callable[[str], None]) -> None:
        self._cut = cut
        self._rounds = (
            (roads.questions, roads.commands, keys.command(name, twin, SEAT)),
            (roads.commands, roads.motions, keys.motion(name, twin, SEAT)),
            (roads.motions, roads.questions, keys.clock(name, twin)),
        )
        self._deaf = dict.fromkeys((key for *_, key in self._rounds), 0)
        self._closed = threading.Event()
        self._thread = threads.start(self._run, "vigil")

    def _run(self) -> None:
        while not self._closed.wait(PERIOD_S):
            for asker, asked, key in self._rounds:
                self._deaf[key] = self._deaf[key] + 1 if self._unheard(asker, asked, key) else 0
                if self._deaf[key] >= DEAF and not self._closed.is_set():
                    self._deaf[key] = 0
                    self._renew(asked, key)

    @staticmethod
    def _unheard(asker: Bus, asked: Bus, key: str) -> bool:
        """The router says that nobody serves the key; silence for another reason says nothing."""
        if not (asker.connected and asked.connected):
            return False
        question = asker.question(key, priority="interactive_high")
        try:
            return question.next(ANSWER_S) is None
        except TimeoutError:
            return False
        finally:
            question.close()

    def _renew(self, bus: Bus, key: str) -> None:
        try:
            bus.renew()
        except NoAnswer:
            return  # the router has gone just now
        self._cut(f"The router had forgotten {key}: connected anew.")

    def close(self) -> None:
        """Ask no more."""
        self._closed.set()
        self._thread.join(timeout=3 * ANSWER_S)
