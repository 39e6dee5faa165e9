"""A process that serves robots: the wait for the router, a clean end on a signal."""

from __future__ import annotations

import gc
import os
import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files, threads
from beatrix_zenoh.bus import ProcessSessions, Sessions
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.node.logs import log_to
from beatrix_zenoh.node.node import Node, RobotBody
from beatrix_zenoh.node.robots import Robots
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import FAULT, Shutdown

RETRY_S, REFUSED_S = 0.5, 5.0
"""Pause before the next attempt to connect; longer after a refusal, because each one occupies the router for 0.1 s."""
KEPT = "robots"
"""Folder, inside that of the user, with the teacher's decisions about each robot."""
SWITCH_S = 0.0005
"""Switch interval (s) of Python's threads, short so that a flood of requests does not delay STOP and the publisher."""


def serve(
    build: Callable[[str, Schedule | None], RobotBody],
    names: Sequence[str],
    settings: Settings,
    *,
    robot: RobotData = ROBOT,
    ready: bool = False,
    legacy: Path | None = None,
    log_file: Path | None = None,
) -> int:
    """Serve robots until a signal arrives; return the exit code: FAULT after an uncaught exception in a thread, else 0.

    `build` makes the robot of a name; of several robots the schedule advances the boards. `ready` (simulation only) switches the motors on and calibrates. `legacy` is the
    path of the terminal for programs of 2023. All log records are written to `log_file`. Prints `ready <key>` for each
    robot when its node serves.

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

        def open_node(name: str, clock: Schedule | None, publishing: Schedule | None) -> Node:
            node = _open(Sessions(sessions), build(name, clock), name, robot, legacy, publishing)
            if ready:
                node.make_ready()
            _announce(node, legacy)
            return node

        try:
            if len(names) == 1:
                return _serve_one(lambda: open_node(names[0], None, None), shutdown)
            return _serve_several(
                names, lambda name, robots: open_node(name, robots.clock, robots.publishing), shutdown
            )
        finally:
            sessions.close()


def _serve_one(open_node: Callable[[], Node], shutdown: Shutdown) -> int:
    """Serve a robot; an uncaught exception in a thread ends it, because it would answer only some requests."""
    broken: list[threading.ExceptHookArgs] = []

    def give_up(died: threading.ExceptHookArgs) -> None:
        traceback.print_exception(died.exc_type, died.exc_value, died.exc_traceback)
        broken.append(died)
        shutdown.request()

    threading.excepthook = give_up
    node = open_node()
    try:
        gc.freeze()  # without this, garbage collection would stop all threads for milliseconds
        shutdown.wait()
    finally:
        node.close()
    return FAULT if broken else 0


def _serve_several(names: Sequence[str], open_node: Callable[[str, Robots], Node], shutdown: Shutdown) -> int:
    """Serve robots; an uncaught exception in a thread of one robot replaces it, one in another thread ends all."""
    broken: list[threading.ExceptHookArgs] = []
    robots = Robots(open_node)

    def replace(died: threading.ExceptHookArgs) -> None:
        owner, error = threads.OWNER.get(), died.exc_value
        if owner is not None and error is not None:
            robots.fail(owner, error)
            return
        traceback.print_exception(died.exc_type, error, died.exc_traceback)
        broken.append(died)
        shutdown.request()

    threading.excepthook = replace
    try:
        for name in names:
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


def _announce(node: Node, legacy: Path | None) -> None:
    """Print that the node serves, with or without a board, and the path for programs of 2023."""
    link = node.board.link
    without = "" if link.connected else " (unusable firmware)" if link.contract_differs else " (no board yet)"
    print(f"ready {node.alive_key}{without}", flush=True)
    if legacy is not None:
        print(f"Old programs open {legacy.absolute()}.", file=sys.stderr, flush=True)


def _open(
    sessions: Sessions,
    hardware: RobotBody,
    name: str,
    robot: RobotData,
    legacy: Path | None,
    publishing: Schedule | None,
) -> Node:
    """Return a started node; if it cannot start, close `sessions`, `hardware` and the terminal."""
    with ExitStack() as undo:
        undo.callback(hardware.close)
        undo.callback(sessions.close)
        terminal = None if legacy is None else Terminal(legacy)
        if terminal is not None:
            undo.callback(terminal.close)
        node = Node(sessions, name, hardware, robot, terminal, files.user_folder() / KEPT, publishing)
        node.start()
        undo.pop_all()
        return node


def _connect(settings: Settings, names: Sequence[str], shutdown: Shutdown) -> ProcessSessions | None:
    """Connect, waiting for the router if necessary; return None if a signal arrives first."""
    if settings.account is not None:
        for name in names:
            settings.account.check_served(name)
    label = names[0] if len(names) == 1 else f"{len(names)} robots"
    reported = False
    while True:
        try:
            return ProcessSessions(
                lambda: zbus.connect(settings.connect, label=label, account=settings.account)
            )
        except NoAnswer as error:
            if not reported:
                print(f"{error.message} The node waits; Ctrl-C ends it.", file=sys.stderr, flush=True)
            reported = True
            if shutdown.requested(REFUSED_S if error.reason is Reason.ACCOUNT_REFUSED else RETRY_S):
                return None
