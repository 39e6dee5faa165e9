"""The node of one robot: a list of components, started in order and closed in reverse order."""

from __future__ import annotations

import threading
from contextlib import ExitStack
from pathlib import Path

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract._generated.serial import FrameType
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.board_watch import BoardWatch, Observer
from beatrix_zenoh.node.commands import CommandHandler
from beatrix_zenoh.node.context import Context, RobotBody
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.decisions import TeacherDecisions
from beatrix_zenoh.node.events import Diagnostics, LogEvents, NodeEvents
from beatrix_zenoh.node.interfaces import Component, StatusFields
from beatrix_zenoh.node.lease_queries import LeaseHandler
from beatrix_zenoh.node.legacy_port import LegacyPort
from beatrix_zenoh.node.motions import ArmTopics, MotionHandler
from beatrix_zenoh.node.planner import Planner
from beatrix_zenoh.node.presence import ClientWatch, claim_name
from beatrix_zenoh.node.requests import RequestQueue
from beatrix_zenoh.node.snapshot import Snapshot
from beatrix_zenoh.node.state import Publisher, StateQueries
from beatrix_zenoh.node.stop import StopHandler


def components(context: Context, terminal: Terminal | None, kept: Path | None) -> list[Component]:
    """Return the components of a node in the order in which they start."""
    decisions, stop = TeacherDecisions(context, kept), StopHandler(context)
    stop.on_stop(decisions.keep)  # an EMERGENCY_STOP may be the teacher's
    commands = CommandHandler(context, stop, decisions.keep)
    return [
        LogEvents(context.events),
        decisions,
        context.board_watch,
        Publisher(context),
        StateQueries(context),
        stop,
        ControllerThread(context),
        commands,
        LeaseHandler(context, decisions.keep),
        MotionHandler(context),
        ArmTopics(context),
        *context.hardware.components(context),
        *([] if terminal is None else [LegacyPort(context, stop, commands, terminal)]),
        ClientWatch(context),
    ]


class ControllerThread(Component):
    """The controller's thread, which carries out the tasks of the request queue one after the other."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        self._thread = threads.start(self._run, "controller")

    def contribute(self, status: StatusFields) -> None:
        status.warnings += self._context.diagnostics.warnings()

    def _run(self) -> None:
        while (task := self._context.queue.take()) is not None:
            task.run()
        self._context.controller.close()

    def close(self) -> None:
        """Decline later requests, carry out the waiting ones, stop the arms."""
        self._context.queue.close()
        if self._thread is not None:
            self._thread.join(timeout=2.0)


class Node:
    """Serves one robot under one name until closed.

    Zenoh's threads only enqueue requests; the controller's thread carries them out, the stop thread sends STOP, the
    publisher's thread publishes. From `start` on the node owns `sessions`, `hardware` and `terminal` and closes them;
    if `start` fails, the caller must close them.
    """

    def __init__(
        self,
        sessions: Sessions,
        name: str,
        hardware: RobotBody,
        robot: RobotData = ROBOT,
        terminal: Terminal | None = None,
        kept: Path | None = None,
    ) -> None:
        """Construct the components; `start` starts the threads.

        `kept` is the folder in which the decisions of the teacher outlive the node; None: they end with it.
        """
        self.sessions, self.hardware = sessions, hardware
        self.context = build_context(sessions, names.check_name(name), hardware, robot)
        self._components = components(self.context, terminal, kept)
        self.context.snapshot.components = self._components

    @property
    def alive_key(self) -> str:
        """Key of this robot's liveliness token."""
        return keys.alive(self.context.name, self.context.side)

    def start(self) -> Node:
        """Claim the name and start the components; return this node.

        Raises:
            Refused: NAME_TAKEN, before any component starts.
            NoAnswer: NO_ROUTER, the router was lost meanwhile; ACCOUNT_REFUSED, it has no rules for the account.
        """
        claim_name(self.sessions.control, self.context.name, self.context.side)
        with ExitStack() as undo:
            undo.callback(self.context.board_watch.board.close)
            for component in self._components:
                undo.callback(component.close)
                component.start(self.sessions)
            undo.pop_all()
        return self

    def make_ready(self) -> None:
        """Switch the motors on and calibrate, which only a simulation may do without a person; raises BeatrixError."""
        board = self.context.board_watch.board
        board.enable(on=True)
        self.hardware.straighten()
        board.request(FrameType.CALIBRATE)

    def close(self) -> None:
        """Stop the motion, reply to open requests, publish the last status, close sessions, board and hardware."""
        with ExitStack() as later:  # runs its callbacks in reverse order
            later.callback(self.hardware.close)
            later.callback(self.context.board_watch.board.close)
            later.callback(self.sessions.close)
            for component in self._components:
                later.callback(component.close)


def build_context(sessions: Sessions, name: str, hardware: RobotBody, robot: RobotData) -> Context:
    """Return the context of a node's components."""
    planner, access, events, queue = Planner(robot), Access(), NodeEvents(), RequestQueue()
    diagnostics = Diagnostics(events)
    board_watch = BoardWatch(hardware, access, queue)
    controller = MotionController(board_watch.board, planner, access, diagnostics)
    # Add the controller first: the other observers, for example that of STOP, read the state of the motion from it.
    board_watch.observe(Observer(controller.observe, controller.overdue))
    return Context(
        name=name,
        side=hardware.side,
        hardware=hardware,
        planner=planner,
        access=access,
        events=events,
        diagnostics=diagnostics,
        queue=queue,
        board_watch=board_watch,
        controller=controller,
        snapshot=Snapshot(name, hardware, board_watch.board, planner, sessions.control.endpoint),
    )
