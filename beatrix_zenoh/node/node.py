"""A robot on the bus: which key leads to which thread, and the order of opening and closing."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack

import msgspec

from beatrix_zenoh import codec, names, requests, threads
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, MotionQuery, PoseQuery, Reason
from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh._generated.serial import FrameType, Telemetry, Text, TextWarning
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.errors import BeatrixError, Refused, quoted
from beatrix_zenoh.node.answers import Asker, not_stopped
from beatrix_zenoh.node.body import Body
from beatrix_zenoh.node.broadcast import Broadcast
from beatrix_zenoh.node.claim import claim
from beatrix_zenoh.node.course import Course
from beatrix_zenoh.node.driver import Driver
from beatrix_zenoh.node.legacy import Legacy
from beatrix_zenoh.node.mailbox import Mailbox, Task
from beatrix_zenoh.node.previewer import Previewer
from beatrix_zenoh.node.reporter import Reporter
from beatrix_zenoh.node.roads import Roads
from beatrix_zenoh.node.stop_desk import StopDesk
from beatrix_zenoh.node.terminal import Terminal
from beatrix_zenoh.node.vigil import Vigil

ARMS = ("short", "middle", "long")
ROADS = {Command.STOP: FrameType.STOP, Command.EMERGENCY_STOP: FrameType.EMERGENCY_STOP}
BOARD_READY_S = 1.7
"""A board that was reset when its port was opened is heard within this long."""
RADIANS = " (Over Zenoh angles are in rad: 10 deg = 0.1745 rad.)"
"""For those who typed a motion in text and are beyond a limit."""


class Desk:
    """A thread that does one thing after another, in the order they were handed over."""

    def __init__(self, name: str) -> None:
        self._work: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._closed = False
        self._thread = threads.start(self._run, name)

    def hand(self, work: Callable[[], None]) -> None:
        """Do `work` soon; once closed, here and now."""
        with self._lock:
            closed = self._closed
            if not closed:
                self._work.put(work)
        if closed:
            work()

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            work()

    def close(self) -> None:
        """Finish what was handed over, then end."""
        with self._lock:
            self._closed = True
            self._work.put(None)
        self._thread.join(timeout=2.0)


class Node:
    """Serves one body under one name until closed.

    Threads: Zenoh's callbacks only hand over to the mailbox (motions and commands), the stop desk
    (STOP alone), the front desk (questions about state) or the previewer; a broadcaster publishes.

    `roads`, `body` and `terminal` are the node's from here on, and closed with it; if it cannot serve, they stay
    the caller's to close.

    Raises:
        Refused: NAME_TAKEN, before anything is declared or moved.
    """

    def __init__(
        self, roads: Roads, name: str, body: Body, robot: RobotData = ROBOT, terminal: Terminal | None = None
    ) -> None:
        self.name, self.twin = names.check_name(name), body.twin
        claim(roads.commands, self.name, self.twin)
        self._roads, self._body = roads, body
        self._course = Course(robot)
        self._mailbox = Mailbox()
        self._legacy: Legacy | None = None
        self._last_state: tuple[int, ...] = ()
        self.board = Board(body.open_port, self._on_telemetry, self._on_link, self._on_text)
        self.driver = Driver(body, self.board, self._course)
        self.reporter = Reporter(
            self.name, body, self.board, self.driver, self._course, roads.commands.endpoint
        )
        self._previewer = Previewer(body, self.board, self._course)
        self._stop_desk = StopDesk(self.board.request, self._stopped)
        self._front_desk = Desk("front")
        self._thread = threads.start(self._work, "driver")
        self.board.start()
        self.board.wait_for(lambda _: True, BOARD_READY_S)
        self._declare()
        if terminal is not None:
            self._legacy = Legacy(
                terminal,
                self.board,
                self.driver,
                body,
                lambda: roads.commands.connected,
                self._mailbox.post_event,
            )
        self._broadcast = Broadcast(roads.commands, self.reporter, self.name, self.twin)
        roads.commands.announce(self.alive_key)
        self._vigil = Vigil(roads, self.name, self.twin, self._cut)

    @property
    def alive_key(self) -> str:
        """Key of this robot's liveliness token."""
        return keys.alive(self.name, self.twin)

    # -- keys -----------------------------------------------------------------------------------

    def _declare(self) -> None:
        name, twin = self.name, self.twin
        bus, motions, questions = self._roads.commands, self._roads.motions, self._roads.questions
        bus.serve(keys.stop(name, twin), lambda incoming: self._stop(incoming, FrameType.STOP))
        bus.subscribe(keys.stop(name, twin), self._stop_put)
        motions.serve(keys.motion(name, twin, "*"), lambda incoming: self._motion(incoming, MotionQuery))
        motions.serve(keys.pose(name, twin, "*"), lambda incoming: self._motion(incoming, PoseQuery))
        bus.serve(keys.command(name, twin, "*"), self._command)
        motions.subscribe(keys.arm_target(name, twin, "*"), self._arm_target)
        bus.watch(keys.seat("*", "*"), self._seat)
        bus.watch_router(self._router)
        reporter = self.reporter
        for key, build in (
            (keys.positions(name, twin), lambda: reporter.positions(count=False)),
            (keys.positions_json(name, twin), lambda: reporter.positions(count=False)),
            (keys.status(name, twin), reporter.status),
            (keys.status_json(name, twin), reporter.status),
            (keys.info(name, twin), reporter.info),
            (keys.clock(name, twin), reporter.clock),
        ):
            questions.serve(key, self._question(key, build))
        if twin == "sim":
            questions.serve(keys.preview(name, "*"), self._preview)

    def _question(self, key: str, build: Callable[[], msgspec.Struct]) -> Callable[[Incoming], None]:
        def answer(incoming: Incoming) -> None:
            incoming.reply(key, *incoming.wording.answer(build()))
            incoming.finish()

        return lambda incoming: self._front_desk.hand(lambda: answer(incoming))

    # -- requests: called on Zenoh's threads, so they only read, hand over, or decline -----------

    def _asker(self, incoming: Incoming, road: str) -> Asker:
        """The way back to who asked, on the robot's own concrete key."""
        parts = incoming.key.split("/")
        who = parts[4] if len(parts) == 6 else ""  # beatrix/robot/twin/cmd/who/road
        # A reply needs a key without wildcards, and must match the query's: a stop may have come on one with.
        seat = "anybody" if not who or "*" in who else who
        key = keys.stop(self.name, self.twin) if road == "stop" else self._own_key(seat, road)
        wording = incoming.wording

        def answer(message: msgspec.Struct) -> None:
            incoming.reply(key, *wording.answer(message))

        return Asker(who, incoming.session, answer, incoming.finish)

    def _own_key(self, who: str, road: str) -> str:
        return f"beatrix/{self.name}/{self.twin}/cmd/{who}/{road}"

    def _check_key(self, incoming: Incoming, who: str, road: str) -> None:
        """Refuse a wildcard: who means many robots at once, or looks around, does not mean to drive this one."""
        own = self._own_key(who or "me", road)
        if incoming.key != own:
            raise Refused(
                Reason.BAD_VALUE,
                f"{quoted(incoming.key)} is no one robot's key: ask {own}. Only a stop may go to many.",
            )

    def _motion(self, incoming: Incoming, kind: type[MotionQuery | PoseQuery]) -> None:
        road, driver = "motion" if kind is MotionQuery else "pose", self.driver

        def run() -> None:
            asker = self._asker(incoming, road)
            try:
                self._check_key(incoming, asker.who, road)
                query = requests.read(incoming.wording, kind)
                names.check_seat(asker.who)
            except Refused as error:
                driver.decline_motion(asker, error)
                return
            driver.motion(query, asker, hint="" if incoming.wording.binary else RADIANS)

        def decline(error: BeatrixError) -> None:
            driver.decline_motion(self._asker(incoming, road), error)

        self._mailbox.post_latest((road, incoming.key), Task(run, decline))  # a wildcard comes on both roads

    def _command(self, incoming: Incoming) -> None:
        asker = self._asker(incoming, "command")
        try:
            query = requests.read(incoming.wording, CommandQuery)
            if query.command not in ROADS:  # whoever and wherever it is, a stop is a stop
                names.check_seat(asker.who)
                self._check_key(incoming, asker.who, "command")
        except Refused as error:
            self.driver.answer_command(asker, error)
            return
        if query.command in ROADS:
            self._stop(incoming, ROADS[Command(query.command)], asker)
            return
        decline, asked_s = self.driver.answer_command, time.monotonic()
        self._mailbox.post(
            Task(lambda: self.driver.command(query, asker, asked_s), lambda e: decline(asker, e))
        )

    def _stop(self, incoming: Incoming | None, road: FrameType, asker: Asker | None = None) -> None:
        if incoming is not None and asker is None:
            if not incoming.key.endswith("/stop"):
                incoming.finish()  # somebody who looks around with `beatrix/**` does not mean STOP
                return
            asker = self._asker(incoming, "stop")
        self.driver.halt("" if asker is None else asker.session, emergency=road is FrameType.EMERGENCY_STOP)
        self._stop_desk.press(road, asker)

    def _stop_put(self, key: str, _payload: bytes) -> None:
        if key.endswith("/stop"):
            self._stop(None, FrameType.STOP)

    def _stopped(self, road: FrameType, asker: Asker | None, error: BeatrixError | None) -> None:
        emergency = road is FrameType.EMERGENCY_STOP

        def decline(closing: BeatrixError) -> None:
            if asker is not None:
                self.driver.answer_command(asker, closing if error is None else not_stopped(error))

        def stopped() -> None:
            if self._legacy is not None:
                self._legacy.call_off()
            self.driver.stopped(asker, error, emergency=emergency)

        self._mailbox.post_urgent(stopped, decline)

    def _arm_target(self, key: str, payload: bytes) -> None:
        arm = key.removesuffix("/target").rpartition("/")[2]

        def run() -> None:
            if key != keys.arm_target(self.name, self.twin, arm):
                self.driver.warn(
                    f"{quoted(key)} is no one robot's key: nothing was moved. Only a stop may go to many."
                )
                return
            if arm not in ARMS:
                self.driver.warn(f"There is no arm {quoted(arm)}; there are {', '.join(ARMS)}.")
                return
            try:
                angle = codec.number(payload)
            except Refused as error:
                self.driver.warn(error.message)
                return
            self.driver.arm_target(ARMS.index(arm), angle)

        self._mailbox.post_latest(f"arm/{arm}", Task(run, lambda _: None))

    def _preview(self, incoming: Incoming) -> None:
        self._previewer.ask(incoming.wording, self._asker(incoming, "preview"))

    def _seat(self, key: str, alive: bool) -> None:  # noqa: FBT001
        session = key.rpartition("/")[2]
        happened = self.driver.client_there if alive else self.driver.client_gone
        self._mailbox.post_event(lambda: happened(session))

    def _router(self, there: bool) -> None:  # noqa: FBT001
        if not there:
            self._mailbox.post_event(self.driver.router_gone)

    def _cut(self, text: str) -> None:
        """Who asked through a session that was renewed waits in vain, and its going may not have been heard."""

        def end() -> None:
            self.driver.warn(text)
            self.driver.router_gone()

        self._mailbox.post_event(end)

    # -- the board's thread ---------------------------------------------------------------------

    def _on_telemetry(self, telemetry: Telemetry) -> None:
        state = (telemetry.state, telemetry.outcome, telemetry.motion, telemetry.boot)
        if state != self._last_state or self.driver.overdue():
            self._last_state = state
            self._mailbox.post_urgent(self.driver.observe)
        if self._legacy is not None and self._legacy.overdue():
            self._mailbox.post_event(self._legacy.look)

    def _on_link(self) -> None:
        self._mailbox.post_urgent(self.driver.observe)
        if self._legacy is not None:
            self._mailbox.post_event(self._legacy.look)

    def _on_text(self, seq: int, frame: Text | TextWarning) -> None:
        if self._legacy is not None:
            self._legacy.told(seq, frame)

    # -- the driver's thread --------------------------------------------------------------------

    def _work(self) -> None:
        while (task := self._mailbox.take()) is not None:
            task.run()
        self.driver.close()

    def make_ready(self) -> None:
        """Switch on and calibrate, as a simulation may without a person; raises BeatrixError."""
        self.board.enable(on=True)
        self._body.straighten()
        self.board.request(FrameType.CALIBRATE)

    def close(self) -> None:
        """Stop motion, tell who waits, publish the last status, leave the bus, free the board; whatever fails on the way."""
        with ExitStack() as later:  # last in, first out
            later.callback(self._body.close)
            later.callback(self.board.close)
            later.callback(self._roads.close)
            later.callback(self._front_desk.close)
            later.callback(self._stop_desk.close)
            later.callback(self._broadcast.close)
            later.callback(self._previewer.close)
            later.callback(self._thread.join, timeout=2.0)
            later.callback(self._mailbox.close)
            later.callback(self._vigil.close)
            if self._legacy is not None:
                later.callback(self._legacy.close)
