"""A process that serves robots: the wait for the router, a clean end on a signal.

Of several robots in one process, one that fails is closed, while the others go on.
"""

from __future__ import annotations

import logging
import sys
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Final

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files, memory, threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import NoAnswer, wrong_usage
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.logs import log_to
from beatrix_zenoh.node.node import Node, RobotBody
from beatrix_zenoh.node.systemd import report
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import FAULT, Shutdown
from beatrix_zenoh.threads import Owner

RETRY_S, REFUSED_S = 0.5, 5.0
"""Pause before the next attempt to connect; longer after a refusal, because each one occupies the router for 0.1 s."""
KEPT = "robots"
"""Folder, inside that of the user, with the teacher's decisions about each robot."""
CLOSE_S: Final = 0.4
"""Time (s) that a failed robot gets to reply to open requests, before its name is freed."""
END_S: Final = 4.0
"""Longest time (s) for the end of all robots."""
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
        raise wrong_usage(
            "--legacy cannot be used with a --robot-file that changes limits or neck: for programs of 2023 only "
            "the limits compiled into the firmware apply. Omit one of the two options.",
        )
    shutdown = Shutdown()
    shutdown.handle_signals()
    sys.setswitchinterval(SWITCH_S)
    alone = len(names) == 1
    with log_to(log_file, named=not alone):
        sessions = _connect(settings, names, shutdown)
        if sessions is None:
            return 0
        robots = Robots(shutdown)
        try:
            for name in names:
                if not shutdown.requested(0):
                    own = sessions if alone else Sessions(sessions.connect, sessions)
                    clock = None if alone else robots.clock
                    robots.nodes[name] = _start(own, build(name), name, robot, legacy, clock, ready=ready)
            memory.keep_loaded()
            shutdown.wait()
        finally:
            robots.close()
            sessions.close()
    return FAULT if robots.failed else 0


def _start(
    sessions: Sessions,
    hardware: RobotBody,
    name: str,
    robot: RobotData,
    legacy: Path | None,
    clock: Schedule | None,
    *,
    ready: bool,
) -> Node:
    """Return a node that serves, and print that it does; if that fails, close what it owns."""
    with ExitStack() as undo:
        undo.callback(hardware.close)
        undo.callback(sessions.close)
        terminal = None if legacy is None else Terminal(legacy)
        if terminal is not None:
            undo.callback(terminal.close)
        node = Node(sessions, name, hardware, robot, terminal, files.user_folder() / KEPT, clock).start()
        undo.pop_all()
        undo.callback(node.close)
        if ready:
            node.make_ready()
        board = node.board
        without = (
            "" if board.connected else " (unusable firmware)" if board.contract_differs else " (no board yet)"
        )
        print(f"ready {node.alive_key}{without}", flush=True)
        if legacy is not None:
            print(f"Old programs open {legacy.absolute()}.", file=sys.stderr, flush=True)
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
            report()  # a node that waits for its router works
            if shutdown.requested(REFUSED_S if error.reason is Reason.ACCOUNT_REFUSED else RETRY_S):
                return None


class Robots:
    """The nodes of a process by name, and the thread `clock`, which advances boards and plants and publishes for all.

    Each node has its own threads for requests and for STOP, so that no robot waits for the requests to another one. A
    robot with an uncaught exception would answer only some requests, so it is closed; without other robots the process
    ends, as after an exception in a thread of no robot.
    """

    def __init__(self, shutdown: Shutdown) -> None:
        """Handle the uncaught exceptions of all threads from now on."""
        self._shutdown = shutdown
        self.nodes: dict[str, Node] = {}
        self.failed = False
        """Whether there was an uncaught exception."""
        self.clock = Schedule("clock", self._fail)
        threading.excepthook = self._handle

    def _handle(self, died: threading.ExceptHookArgs) -> None:
        if died.exc_value is not None:
            self._fail(threads.OWNER.get(), died.exc_value)

    def _fail(self, owner: Owner | None, error: BaseException) -> None:
        """Close a robot that has failed, or end the process; any thread may call this."""
        traceback.print_exception(error)
        self.failed = True
        if owner is None or not self.nodes.keys() - {owner.name}:
            self._shutdown.request()
        elif node := self.nodes.pop(owner.name, None):
            threads.start(lambda: _take_down(node, error), "closing")

    def close(self) -> None:
        """Close all nodes at the same time, then end the thread."""
        closing = [threads.start(lambda node=node: _close(node), "closing") for node in self.nodes.values()]  # type: ignore[misc]
        until_s = time.monotonic() + END_S
        for thread in closing:
            thread.join(max(0.0, until_s - time.monotonic()))
        self.clock.close()


def _take_down(node: Node, error: BaseException) -> None:
    """Close a node, for CLOSE_S at most: a part of it may hang; then free its name."""
    closing = threads.start(lambda: _close(node), "closing")
    closing.join(CLOSE_S)
    node.sessions.close()
    cause = "".join(traceback.format_exception_only(error)).strip()
    with threads.owned_by(node.owner):  # the log then names the robot
        _log.error(
            "It has failed (%s) and stays down; the other robots go on. `beatrix sim --name %s` starts it in a second "
            "terminal.",
            cause,
            node.name,
        )


def _close(node: Node) -> None:
    try:
        node.close()
    except Exception:  # noqa: BLE001 - the other parts of the node are closed, and the other robots go on
        _log.exception("An error while %s was closed.", node.name)
