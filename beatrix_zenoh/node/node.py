"""The node of one robot: a list of components, started in order and closed in reverse order."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract._generated.serial import FrameType
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.logs import LOGGERS
from beatrix_zenoh.node import events
from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.board_watch import BoardWatch, Observer
from beatrix_zenoh.node.commands import CommandHandler
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.decisions import TeacherDecisions
from beatrix_zenoh.node.events import Diagnostics, NodeEvents
from beatrix_zenoh.node.interfaces import Component, HardwareInterface, StatusFields
from beatrix_zenoh.node.lease_queries import LeaseHandler
from beatrix_zenoh.node.legacy_port import LegacyPort
from beatrix_zenoh.node.motions import ArmTopics, MotionHandler
from beatrix_zenoh.node.planner import Planner
from beatrix_zenoh.node.presence import ClientWatch, claim_name
from beatrix_zenoh.node.requests import ControllerQueue, Requests
from beatrix_zenoh.node.snapshot import Snapshot
from beatrix_zenoh.node.state import Publisher, StateQueries
from beatrix_zenoh.node.stop import StopHandler
from beatrix_zenoh.node.systemd import SystemdReports
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.threads import Owner


class LogEvents(Component, logging.Handler):
    """Adds the records of our loggers to the event log, except those of the event log itself and of other robots."""

    def __init__(self, log: NodeEvents, owner: Owner) -> None:
        logging.Handler.__init__(self, logging.INFO)
        self._events, self._owner = log, owner

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        for name in LOGGERS:
            logging.getLogger(name).addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Add a record; called by logging, on any thread."""
        if record.name != events.log.name and threads.OWNER.get() in (None, self._owner):
            message = f"{record.name}: {record.getMessage()}"
            self._events.add(events.new_event(kind=EventKind.LOG, action=record.levelname, message=message))

    def close(self) -> None:
        """Remove the handler."""
        for name in LOGGERS:
            logging.getLogger(name).removeHandler(self)
        logging.Handler.close(self)


class ControllerThread(Component):
    """The controller's thread, which carries out the tasks of the request queue one after the other."""

    def __init__(
        self, queue: ControllerQueue, controller: MotionController, changed: Callable[[], None]
    ) -> None:
        """`changed` is called after each entry of the queue, because the status may have changed."""
        self._queue, self._controller, self._changed = queue, controller, changed
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        self._thread = threads.start(self._run, "controller")

    def contribute(self, status: StatusFields) -> None:
        status.warnings += self._controller.diagnostics.warnings()

    def _run(self) -> None:
        while (run := self._queue.take()) is not None:
            run()
            self._changed()
        self._controller.close()

    def close(self) -> None:
        """Decline later requests, carry out the waiting ones, stop the arms."""
        self._queue.close()
        if self._thread is not None:
            self._thread.join(timeout=2.0)


class RobotBody(HardwareInterface, Protocol):
    """A robot with the components that only its kind has."""

    def components(self, node: Node) -> list[Component]:
        """Return the components that only this kind of robot has: previews, cameras."""


class Node:
    """Serves one robot under one name until closed.

    Zenoh's threads only enqueue requests; the controller's thread carries them out, the stop thread sends STOP, the
    clock's thread advances a virtual board and publishes. From `start` on the node owns `sessions`, `hardware` and `terminal` and closes them;
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
        clock: Schedule | None = None,
    ) -> None:
        """Construct the components; `start` starts the threads.

        `kept` is the folder in which the decisions of the teacher outlive the node; None: they end with it. `clock` is the
        thread that advances several virtual boards and publishes for them; None: this node has one of its own.
        """
        self.owner = Owner(name)
        self.sessions, self.hardware = sessions, hardware
        self.name, self.side = names.check_name(name), hardware.side
        self.events, queue = NodeEvents(owner=self.owner), ControllerQueue()
        planner, access, diagnostics = Planner(robot), Access(), Diagnostics(self.events)
        self.requests = Requests(name, self.side, queue, self.events)
        self._own_clock = Schedule("clock")
        clock = clock or self._own_clock
        self.board_watch = BoardWatch(hardware, access, queue, self.owner, clock)
        self.board = self.board_watch.board
        self.controller = MotionController(self.board, planner, access, diagnostics)
        self.snapshot = Snapshot(name, hardware, self.board, planner, sessions.control.endpoint)
        # Add the controller first: the other observers, for example that of STOP, read the state of the motion from it.
        self.board_watch.observe(Observer(self.controller.observe, self.controller.overdue))
        path = None if kept is None else kept / f"{name}.{self.side}.toml"
        self.snapshot.components = self._components = self._build(terminal, path, clock)

    def _build(self, terminal: Terminal | None, kept: Path | None, clock: Schedule) -> list[Component]:
        """Return the components in the order in which they start; `kept`: file of the teacher's decisions."""
        requests, controller, watch, hardware = (
            self.requests,
            self.controller,
            self.board_watch,
            self.hardware,
        )
        decisions, stop = TeacherDecisions(controller, kept), StopHandler(requests, controller, watch)
        controller.on_stop.append(decisions.keep)  # an EMERGENCY_STOP may be the teacher's
        publisher = Publisher(self.snapshot, self.events, self.owner, clock)
        clients = ClientWatch(requests, controller)
        port = terminal and LegacyPort(requests, controller, watch, hardware, terminal, clients.has_router)
        return [
            LogEvents(self.events, self.owner),
            decisions,
            watch,
            publisher,
            StateQueries(self.snapshot, self.events),
            stop,
            ControllerThread(requests.queue, controller, publisher.changed),
            CommandHandler(requests, controller, hardware, stop.press, decisions.keep),
            LeaseHandler(requests, controller, decisions.keep),
            MotionHandler(requests, controller),
            ArmTopics(requests, controller),
            *hardware.components(self),
            *([port] if port else []),
            clients,
            SystemdReports(requests.queue, self.owner, clock),
        ]

    @property
    def alive_key(self) -> str:
        """Key of this robot's liveliness token."""
        return keys.alive(self.name, self.side)

    def start(self) -> Node:
        """Claim the name and start the components; return this node.

        Raises:
            Refused: NAME_TAKEN, before any component starts.
            NoAnswer: NO_ROUTER, the router was lost meanwhile; ACCOUNT_REFUSED, it has no rules for the account.
        """
        claim_name(self.sessions, self.name, self.side)
        with threads.owned_by(self.owner), ExitStack() as undo:
            undo.callback(self._own_clock.close)
            undo.callback(self.board.close)
            for component in self._components:
                undo.callback(component.close)
                component.start(self.sessions)
            undo.pop_all()
        return self

    def make_ready(self) -> None:
        """Switch the motors on and calibrate, which only a simulation may do without a person; raises BeatrixError."""
        self.board.enable(on=True)
        self.hardware.straighten()
        self.board.request(FrameType.CALIBRATE)

    def close(self) -> None:
        """Stop the motion, reply to open requests, publish the last status, close sessions, board and hardware."""
        with ExitStack() as later:  # runs its callbacks in reverse order
            later.callback(self._own_clock.close)
            later.callback(self.hardware.close)
            later.callback(self.board.close)
            later.callback(self.sessions.close)
            for component in self._components:
                later.callback(component.close)
