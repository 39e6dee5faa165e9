"""A process that serves robots: the wait for the router, a clean end on a signal.

Of several robots in one process, one that fails is started anew, while the others go on.
"""

from __future__ import annotations

import gc
import logging
import os
import queue
import sys
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Final, Protocol

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files, threads
from beatrix_zenoh.bus import Bus, Sessions
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused, WrongUsage
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.logs import log_to
from beatrix_zenoh.node.node import Node, RobotBody
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import FAULT, Shutdown
from beatrix_zenoh.threads import Owner

RETRY_S, REFUSED_S = 0.5, 5.0
"""Pause before the next attempt to connect; longer after a refusal, because each one occupies the router for 0.1 s."""
KEPT = "robots"
"""Folder, inside that of the user, with the teacher's decisions about each robot."""
CLOSE_S: Final = 0.4
"""Time (s) that a failed robot gets to reply to open requests, before its name is freed for the new one."""
END_S: Final = 4.0
"""Longest time (s) for the end of all robots."""
FREED_S, FREE_POLL_S = 5.0, 0.05
"""Longest time (s) until the router has freed the name of a robot that was closed, and the pause between attempts."""
AGAIN_S: Final = 60.0
"""A robot that fails twice within this time (s) stays down."""
SIM: Final = "sim"
"""Side of several robots of one process; a hardware node serves one."""
SWITCH_S = 0.0005
"""Switch interval (s) of Python's threads, short so that a flood of requests does not delay STOP and the publisher."""
_log = logging.getLogger(__name__)


def serve(
    build: Callable[[str], RobotBody],
    names: Sequence[str],
    settings: Settings,
    *,
    robot: RobotData = ROBOT,
    ready: bool = False,
    legacy: Path | None = None,
    log_file: Path | None = None,
) -> int:
    """Serve robots until a signal arrives; return the exit code: FAULT after an uncaught exception in a thread, else 0.

    `build` makes the robot of a name. `ready` (simulation only)
    switches the motors on and calibrates. `legacy` is the path of the terminal for programs of 2023. All log records
    are written to `log_file`. Prints `ready <key>` for each robot when its node serves.

    Raises:
        BeatrixError: a node cannot serve: its name is taken, the router was lost meanwhile, or an option is wrong.
    """
    if legacy is not None and (robot.limits, robot.geometry) != (ROBOT.limits, ROBOT.geometry):
        raise WrongUsage(
            Reason.BAD_VALUE,
            "--legacy cannot be used with a --robot-file that changes limits or neck: for programs of 2023 only "
            "the limits compiled into the firmware apply. Omit one of the two options.",
        )
    shutdown = Shutdown()
    shutdown.handle_signals()
    sys.setswitchinterval(SWITCH_S)
    with log_to(log_file, named=len(names) > 1):
        sessions = _connect(settings, names, shutdown)
        if sessions is None:
            return 0

        def open_node(name: str, robots: Robots | None = None, warning: str = "") -> Node:
            clock = robots.clock if robots else None
            own = Sessions(sessions.connect, sessions) if robots else sessions
            node = _open(own, build(name), name, robot, legacy, clock, warning)
            _begin(node, legacy, ready=ready)
            return node

        try:
            if len(names) == 1:
                return _serve_one(lambda: open_node(names[0]), shutdown)
            _check_free(names, sessions.control)
            return _serve_several(names, open_node, shutdown)
        finally:
            sessions.close()


def _serve_one(open_node: Callable[[], Node], shutdown: Shutdown) -> int:
    """Serve a robot; an uncaught exception in a thread ends it, because it would answer only some requests."""
    broken = _handle_exceptions(shutdown)
    node = open_node()
    try:
        gc.freeze()  # without this, garbage collection would stop all threads for milliseconds
        shutdown.wait()
    finally:
        node.close()
    return FAULT if broken else 0


def _serve_several(names: Sequence[str], open_node: OpenNode, shutdown: Shutdown) -> int:
    """Serve robots; an uncaught exception in a thread of one robot replaces it, one in another thread ends all."""
    robots = Robots(open_node)
    broken = _handle_exceptions(shutdown, robots)
    try:
        for name in names:
            if not shutdown.requested(0):
                robots.start(name)
        gc.freeze()  # as above
        shutdown.wait()
    finally:
        robots.close()
    code = FAULT if broken or robots.failed else 0
    if robots.hung:
        sys.stdout.flush()
        os._exit(code)  # Python would wait for threads that hang
    return code


def _check_free(names: Sequence[str], bus: Bus) -> None:
    """Raise Refused (NAME_TAKEN) with all names that are online, before any robot of the others is announced."""
    online = [name for name, side in bus.robots() if side == SIM]
    if taken := [name for name in names if name in online]:
        others = " ".join(f"--name {name}" for name in names if name not in online)
        instead = f", or simulate the others: beatrix sim {others}" if others else "."
        raise Refused(
            Reason.NAME_TAKEN,
            f"Already simulated by another program at {bus.endpoint}: {', '.join(taken)}. End it{instead}",
        )


def _handle_exceptions(shutdown: Shutdown, robots: Robots | None = None) -> list[threading.ExceptHookArgs]:
    """Handle uncaught exceptions in threads: one in a thread of a robot of `robots` replaces the robot.

    Any other is printed, appended to the list that is returned, and ends the process.
    """
    broken: list[threading.ExceptHookArgs] = []

    def handle(died: threading.ExceptHookArgs) -> None:
        owner, error = threads.OWNER.get(), died.exc_value
        if robots is not None and owner is not None and error is not None:
            robots.fail(owner, error)
            return
        traceback.print_exception(died.exc_type, error, died.exc_traceback)
        broken.append(died)
        shutdown.request()

    threading.excepthook = handle
    return broken


def _begin(node: Node, legacy: Path | None, *, ready: bool) -> None:
    """Make the robot ready if this is wanted, then print that the node serves; close a node for which this fails."""
    with ExitStack() as undo:
        undo.callback(node.close)
        if ready:
            node.make_ready()
        link = node.board.link
        without = (
            "" if link.connected else " (unusable firmware)" if link.contract_differs else " (no board yet)"
        )
        print(f"ready {node.alive_key}{without}", flush=True)
        if legacy is not None:
            print(f"Old programs open {legacy.absolute()}.", file=sys.stderr, flush=True)
        undo.pop_all()


def _open(
    sessions: Sessions,
    hardware: RobotBody,
    name: str,
    robot: RobotData,
    legacy: Path | None,
    clock: Schedule | None,
    warning: str,
) -> Node:
    """Return a started node; if it cannot start, close `sessions`, `hardware` and the terminal.

    `warning` is in its status from the beginning; empty: none.
    """
    with ExitStack() as undo:
        undo.callback(hardware.close)
        undo.callback(sessions.close)
        terminal = None if legacy is None else Terminal(legacy)
        if terminal is not None:
            undo.callback(terminal.close)
        node = Node(sessions, name, hardware, robot, terminal, files.user_folder() / KEPT, clock)
        if warning:
            with threads.owned_by(node.owner):
                node.controller.diagnostics.warn(warning, Reason.FAULT)
        node.start()
        undo.pop_all()
        return node


def _connect(settings: Settings, names: Sequence[str], shutdown: Shutdown) -> Sessions | None:
    """Connect, waiting for the router if necessary; return None if a signal arrives first."""
    if settings.account is not None:
        for name in names:
            settings.account.check_served(name)
    label = names[0] if len(names) == 1 else f"{len(names)} robots"
    reported = False
    while True:
        try:
            return Sessions(lambda: zbus.connect(settings.connect, label=label, account=settings.account))
        except NoAnswer as error:
            if not reported:
                print(f"{error.message} The node waits; Ctrl-C ends it.", file=sys.stderr, flush=True)
            reported = True
            if shutdown.requested(REFUSED_S if error.reason is Reason.ACCOUNT_REFUSED else RETRY_S):
                return None


class OpenNode(Protocol):
    """Starts a node that uses the threads of `Robots`, with a warning in its status from the beginning."""

    def __call__(self, name: str, robots: Robots, warning: str) -> Node: ...


class Robots:
    """The nodes of a process by name, and the thread `clock`, which advances boards and plants and publishes for all.

    Each node has its own threads for requests and for STOP, so that no robot waits for the requests to another one.
    """

    def __init__(self, open_node: OpenNode) -> None:
        """Start the threads that serve all robots."""
        self._open_node = open_node
        self.failed = False
        """Whether a robot is down because it has failed."""
        self.hung = False
        """Whether a thread of the process hangs in code that cannot be ended."""
        self._nodes: dict[str, Node] = {}
        self._failed_s: dict[str, float] = {}
        self._closing = threading.Event()
        self._faults: queue.SimpleQueue[tuple[Owner, BaseException] | None] = queue.SimpleQueue()
        self.clock = Schedule("clock", self.fail)
        self._thread = threads.start(self._run, "robots")

    def start(self, name: str, warning: str = "") -> None:
        """Start the robot of this name, with a warning in its status; raises the errors of `open_node`."""
        self._nodes[name] = self._open_node(name, self, warning)

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
        traceback.print_exception(error)
        cause = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        del self._nodes[name]
        self._end(node)
        now_s = time.monotonic()
        again, self._failed_s[name] = now_s - self._failed_s.get(name, float("-inf")) < AGAIN_S, now_s
        if again:
            self._stays_down(name, f"It has failed twice within {AGAIN_S:.0f} s ({cause}).")
            return
        self._start_again(name, cause)

    def _start_again(self, name: str, cause: str) -> None:
        """Start a robot that has failed; wait for a router that is away, and until the router has freed its name."""
        warning = f"The program of {name} had failed ({cause}). It is started anew, as if it had just been switched on."
        freed_s = time.monotonic() + FREED_S
        while True:
            try:
                return self.start(name, warning)
            except BeatrixError as refusal:
                busy = refusal.reason is Reason.NAME_TAKEN and time.monotonic() < freed_s
                if not busy and refusal.reason is not Reason.NO_ROUTER:
                    why = f"It has failed ({cause}) and cannot be started again: {refusal.message}"
                    return self._stays_down(name, why)
            if self._closing.wait(FREE_POLL_S if busy else RETRY_S):
                return None

    def _stays_down(self, name: str, why: str) -> None:
        self.failed = True
        _log.error(
            "%s stays down; the other robots go on. %s `beatrix sim --name %s` starts it in a second terminal.",
            name,
            why,
            name,
        )

    def _end(self, node: Node) -> None:
        """Close a node, for CLOSE_S at most: a part of it may hang; then free its name."""
        closing = threads.start(lambda: _close(node), "closing")
        closing.join(CLOSE_S)
        node.sessions.close()
        self.hung |= closing.is_alive()

    def close(self) -> None:
        """Close all nodes at the same time, then end the threads."""
        self._closing.set()
        self._faults.put(None)
        self._thread.join(timeout=END_S)
        closing = [threads.start(lambda node=node: _close(node), "closing") for node in self._nodes.values()]  # type: ignore[misc]
        until_s = time.monotonic() + END_S
        for thread in closing:
            thread.join(max(0.0, until_s - time.monotonic()))
        self.clock.close()


def _close(node: Node) -> None:
    try:
        node.close()
    except Exception:  # noqa: BLE001 - the other parts of the node are closed, and the other robots go on
        _log.exception("An error while %s was closed.", node.name)
