"""Run a node as a process: wait for the router, serve, end cleanly on a signal."""

from __future__ import annotations

import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.ending import Ending
from beatrix_zenoh.errors import NoAnswer, WrongUsage
from beatrix_zenoh.node.body import Body
from beatrix_zenoh.node.node import Node
from beatrix_zenoh.node.notices import RESTARTED
from beatrix_zenoh.node.roads import Roads
from beatrix_zenoh.node.terminal import Terminal
from beatrix_zenoh.settings import Settings

RETRY_S = 0.5
SWITCH_S = 0.0005
"""Python hands the interpreter on this often: STOP and the publisher must not wait behind a flood."""


def serve(
    build: Callable[[], Body],
    settings: Settings,
    *,
    robot: RobotData = ROBOT,
    ready: bool = False,
    legacy: Path | None = None,
) -> int:
    """Serve a body until a signal comes; returns the exit code.

    `ready` switches the motors on and calibrates at the start, which only a simulation may. Old
    programs open a terminal at `legacy`.
    Prints `ready <key>` on stdout when the robot serves.

    Raises:
        BeatrixError: it cannot serve: its name is taken, or its router goes while it begins.
    """
    if legacy is not None and (robot.limits, robot.geometry) != (ROBOT.limits, ROBOT.geometry):
        raise WrongUsage(
            Reason.BAD_VALUE,
            "--legacy and a --robot-file with other limits or another neck do not go together: programs of 2023 obey "
            "what is compiled into the firmware. Leave one of them out.",
        )
    ending = Ending()
    broken: list[threading.ExceptHookArgs] = []

    def give_up(died: threading.ExceptHookArgs) -> None:
        """A node with a dead thread would answer only half: better to end, loudly."""
        traceback.print_exception(died.exc_type, died.exc_value, died.exc_traceback)
        broken.append(died)
        ending.ask()

    threading.excepthook = give_up

    ending.heed_signals()
    sys.setswitchinterval(SWITCH_S)
    roads = _connect(settings, ending)
    if roads is None:
        return 0
    node = _open(roads, build(), settings, robot, legacy)
    try:
        if ready:
            node.make_ready()
        _greet(node, legacy)
        ending.wait(teller(node.board, roads.commands))
    finally:
        node.close()
    return 1 if broken else 0


def _greet(node: Node, legacy: Path | None) -> None:
    """Say that it serves, and what a person should know."""
    print("ready", node.alive_key, flush=True)
    if legacy is not None:
        print(f"Old programs open {legacy.absolute()}.", file=sys.stderr, flush=True)


def teller(board: Board, router: Bus) -> Callable[[], None]:
    """Says on stderr what is wrong with the board, and from then on what changes, there and with the router."""
    before, there = board.link, True
    boot = before.boot
    if before.trouble:
        print(before.trouble, file=sys.stderr, flush=True)

    def tell() -> None:
        nonlocal before, boot, there
        if router.connected != there:
            there = not there
            told = (
                "is there again"
                if there
                else "has gone: motions are ended, and nobody is heard until it is back"
            )
            print(f"The router at {router.endpoint} {told}.", file=sys.stderr, flush=True)
        link = board.link
        if link.trouble != before.trouble:
            print(link.trouble or f"The board at {link.port} is there.", file=sys.stderr, flush=True)
        if boot and link.understood and link.boot != boot:
            print(RESTARTED, file=sys.stderr, flush=True)
        before, boot = link, link.boot or boot

    return tell


def _open(roads: Roads, body: Body, settings: Settings, robot: RobotData, legacy: Path | None) -> Node:
    """A node that serves; closes what it was given if it cannot."""
    with ExitStack() as undo:
        undo.callback(body.close)
        undo.callback(roads.close)
        terminal = None if legacy is None else Terminal(legacy)
        if terminal is not None:
            undo.callback(terminal.close)
        node = Node(roads, settings.robot, body, robot, terminal)
        undo.pop_all()
        return node


def _connect(settings: Settings, ending: Ending) -> Roads | None:
    """Sessions, waiting for the router if need be; None if told to end before it came."""
    told = False
    while True:
        try:
            return Roads.open(lambda: zbus.connect(settings.connect, label=settings.robot))
        except NoAnswer as error:
            if not told:
                print(f"{error.message} Waiting for it; Ctrl-C ends.", file=sys.stderr, flush=True)
            told = True
            if ending.asked(RETRY_S):
                return None
