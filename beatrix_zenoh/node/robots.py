"""Several robots in one process; one that fails is started anew, while the others go on."""

from __future__ import annotations

import logging
import queue
import time
import traceback
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.node.node import Node
from beatrix_zenoh.schedule import HangWatch, Hung, Schedule
from beatrix_zenoh.threads import Owner

CLOSE_S: Final = 0.4
"""Time (s) that a failed robot gets to reply to open requests, before its name is freed for the new one."""
END_S: Final = 4.0
"""Longest time (s) for the end of all robots."""
AGAIN_S: Final = 60.0
"""A robot that fails twice within this time (s) stays down."""
_log = logging.getLogger(__name__)


class Robots:
    """The nodes of a process by name, and the threads that they share.

    `clock` advances the boards and plants of all, `publishing` publishes for all. Each node has its own threads for
    requests and for STOP, so that no robot waits for the requests to another one.
    """

    def __init__(self, open_node: Callable[[str, Robots], Node]) -> None:
        """Start the shared threads; `open_node` returns a started node, which uses them."""
        self._open_node = open_node
        self.failed = False
        """Whether a robot is down because it has failed."""
        self.hung = False
        """Whether a thread of the process hangs in code that cannot be ended."""
        self._nodes: dict[str, Node] = {}
        self._failed_s: dict[str, float] = {}
        self._faults: queue.SimpleQueue[tuple[Owner, BaseException] | None] = queue.SimpleQueue()
        self.clock, self.publishing = Schedule("board", self.fail), Schedule("publisher", self.fail)
        self._watch = HangWatch(self.clock, self.publishing)
        self._thread = threads.start(self._run, "robots")

    def start(self, name: str) -> Node:
        """Start the robot of this name and return its node; raises the errors of `open_node`."""
        node = self._nodes[name] = self._open_node(name, self)
        return node

    def fail(self, owner: Owner, error: BaseException) -> None:
        """Replace a robot that has failed; any thread may call this."""
        self._faults.put((owner, error))

    # -- on the thread of this object ---------------------------------------------------------------

    def _run(self) -> None:
        while (fault := self._faults.get()) is not None:
            self._replace(*fault)

    def _replace(self, owner: Owner, error: BaseException) -> None:
        """Close a robot that has failed, and start it anew unless it has failed just before."""
        name, node = owner.name, self._nodes.get(owner.name)
        if node is None or node.owner is not owner:
            return  # a later error of a robot that was replaced
        if not isinstance(error, Hung):
            traceback.print_exception(error)
        cause = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        del self._nodes[name]
        self._end(node)
        now_s = time.monotonic()
        again, self._failed_s[name] = now_s - self._failed_s.get(name, float("-inf")) < AGAIN_S, now_s
        if again:
            self._stays_down(name, f"It has failed twice within {AGAIN_S:.0f} s ({cause}).")
            return
        try:
            new = self.start(name)
        except BeatrixError as refusal:
            self._stays_down(name, f"It has failed ({cause}) and cannot be started again: {refusal.message}")
            return
        text = f"The program of {name} had failed ({cause}). It was started anew, as if it had just been switched on."
        with threads.owned_by(new.owner):
            new.controller.diagnostics.warn(text, Reason.FAULT)

    def _stays_down(self, name: str, why: str) -> None:
        self.failed = True
        _log.error(
            "%s stays down; the other robots go on. %s End this process and start it again.", name, why
        )

    def _end(self, node: Node) -> None:
        """Close a node, for CLOSE_S at most: a part of it may hang; then free its name."""
        closing = threads.start(lambda: _close(node), "closing")
        closing.join(CLOSE_S)
        node.sessions.close()
        self.hung |= closing.is_alive()

    def close(self) -> None:
        """Close all nodes at the same time, then end the threads."""
        self._faults.put(None)
        self._thread.join(timeout=END_S)
        closing = [threads.start(lambda node=node: _close(node), "closing") for node in self._nodes.values()]  # type: ignore[misc]
        until_s = time.monotonic() + END_S
        for thread in closing:
            thread.join(max(0.0, until_s - time.monotonic()))
        self._watch.close()
        self.clock.close()
        self.publishing.close()


def _close(node: Node) -> None:
    try:
        node.close()
    except Exception:  # noqa: BLE001 - the other parts of the node are closed, and the other robots go on
        _log.exception("An error while %s was closed.", node.name)
