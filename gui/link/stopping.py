"""STOP to both robots or to all, sent by a thread that waits for nothing else."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

from beatrix_zenoh import threads
from beatrix_zenoh._generated.messages import CommandReply, Reason
from beatrix_zenoh.client import Place
from beatrix_zenoh.client.group_stop import STOP_S, request_stop
from beatrix_zenoh.client.request import GroupRequest
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.wakeup import Wakeup
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused
from gui.link.connection import Session
from gui.link.outcomes import done, failed, of_several
from gui.link.worker import Worker, show_error
from gui.state.actions import Outcome

NO_REPLY = "No answer: the robot's node hangs or is not connected. Switch the robot's power off if it moves."
YIELD_S = 0.002
"""Longest time that Qt's thread yields to the thread that sends STOP."""


class SentStop(NamedTuple):
    """A STOP that was sent to one robot, and the function that waits until the robot's arms rest."""

    row: int
    wait: Callable[[], CommandReply]


class StopReplies:
    """Waits for one robot's replies to STOP and reports them.

    Each robot has its own thread, so that a silent robot does not delay the reports of the other robot.
    """

    def __init__(self, twin: str, report: Callable[[Outcome], None]) -> None:
        self._twin, self._report = twin, report
        self._pressed: queue.SimpleQueue[SentStop | None] = queue.SimpleQueue()
        self._thread = threads.start(self._run, f"window-rest-{twin}")

    def put(self, pressed: SentStop | None) -> None:
        """Report the reply to this STOP; None ends the thread."""
        self._pressed.put(pressed)

    def _run(self) -> None:
        while (first := self._pressed.get()) is not None:
            all_pressed = [first]
            while not self._pressed.empty():
                if (pressed := self._pressed.get()) is None:
                    return
                all_pressed.append(pressed)
            self._report_all(all_pressed)

    def _report_all(self, all_pressed: list[SentStop]) -> None:
        """Report the reply to the newest STOP for all, because for a silent robot the waits would add up."""
        began_s = time.monotonic()
        try:
            reply = all_pressed[-1].wait()
        except BeatrixError as error:
            for pressed in all_pressed:
                self._report(failed(pressed.row, self._twin, error))
            return
        for pressed in all_pressed:
            self._report(done(pressed.row, self._twin, reply.message, time.monotonic() - began_s))

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the thread until `deadline_s` (monotonic clock, s)."""
        self._thread.join(max(0.0, deadline_s - time.monotonic()))


class AllStopReplies(Worker):
    """Waits for the replies of all robots to STOP and reports them."""

    def __init__(self, report: Callable[[Outcome], None]) -> None:
        super().__init__("window-rest-all")
        self._report = report

    def expect(self, row: int, request: GroupRequest[CommandReply], present: Sequence[Place]) -> None:
        """Report, after the replies, which robots have stopped; those in `present` should reply. Returns at once."""
        self.put(lambda: self._report(self._outcome(row, request, present)))

    def _outcome(self, row: int, request: GroupRequest[CommandReply], present: Sequence[Place]) -> Outcome:
        replies = dict(request.replies(STOP_S))
        failed: dict[Place, BeatrixError] = {
            place: Refused(reply.reason, reply.message)
            for place, reply in replies.items()
            if reply.reason is not Reason.OK
        }
        silent = sorted({*present} - {*replies})
        failed |= {place: NoAnswer(Reason.TIMED_OUT, NO_REPLY) for place in silent}
        return of_several(row, len({*present, *replies}), failed)


class Stopping:
    """A thread that sends STOP to both robots, the hardware first, or to all robots at the router."""

    def __init__(
        self,
        robots: Callable[[], tuple[Robot, ...]],
        session: Callable[[], Session | None],
        no_session: Callable[[int], Outcome],
        report: Callable[[Outcome], None],
    ) -> None:
        """Start the thread.

        Args:
            robots: returns hardware and simulation; empty without a session.
            session: returns the present session, or None.
            no_session: returns the outcome of the STOP of a row if there is no session.
            report: receives the outcomes.
        """
        self._robots, self._session = robots, session
        self._no_session, self._report = no_session, report
        self._sent = 0
        self._wakeup = Wakeup()
        self._pressed: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._rests = {twin: StopReplies(twin, report) for twin in ("hw", "sim")}
        self._all_rest = AllStopReplies(report)
        self._thread = threads.start(self._run, "window-stop")

    def press(self, row: int) -> None:
        """Send STOP to both robots now; returns when STOP was sent, after YIELD_S at the latest."""
        self._press(lambda: self._send(row))

    def press_all(self, row: int) -> None:
        """Send STOP to all robots at the router, in the same way."""
        self._press(lambda: self._send_to_all(row))

    def _press(self, send: Callable[[], None]) -> None:
        before = self._sent
        self._pressed.put(send)
        # Without this wait Python would run this thread for 5 ms before it switches to the thread that sends.
        self._wakeup.wait_for(lambda: self._sent != before, YIELD_S)

    def _run(self) -> None:
        while (send := self._pressed.get()) is not None:
            try:
                send()
            except Exception as error:  # noqa: BLE001  # the next STOP must work
                show_error(error)

    def _send(self, row: int) -> None:
        robots = self._robots()
        for robot in robots:
            try:
                pressed = SentStop(row, robot.press_stop())
            except BeatrixError as error:
                self._report(failed(row, robot.twin, error))
            else:
                self._rests[robot.twin].put(pressed)
        self._sent += 1
        self._wakeup.set()
        if not robots:
            self._report(self._no_session(row))

    def _send_to_all(self, row: int) -> None:
        session = self._session()
        if session is not None:
            request = request_stop(session.client)
            self._all_rest.expect(row, request, session.monitor.present())
        self._sent += 1
        self._wakeup.set()
        if session is None:
            self._report(self._no_session(row))

    def close(self) -> None:
        """End the threads; returns at once."""
        self._pressed.put(None)
        self._all_rest.close()
        for rest in self._rests.values():
            rest.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the threads until `deadline_s` (monotonic clock, s)."""
        self._thread.join(max(0.0, deadline_s - time.monotonic()))
        for rests in self._rests.values():
            rests.join(deadline_s)
        self._all_rest.join(deadline_s)
