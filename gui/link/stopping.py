"""STOP on a thread of its own, which waits for nothing else, to both robots."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable
from typing import NamedTuple

from beatrix_zenoh import threads
from beatrix_zenoh._generated.messages import CommandReply
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.wakeup import Wakeup
from beatrix_zenoh.errors import BeatrixError
from gui.link.outcomes import done, failed
from gui.link.worker import show_error
from gui.state.actions import Outcome

YIELD_S = 0.002
"""Longest time that Qt's thread yields to the thread that sends STOP."""


class SentStop(NamedTuple):
    """A STOP that was sent to one robot, and the function that waits until its arms rest."""

    row: int
    wait: Callable[[], CommandReply]


class StopReplies:
    """Waits for one robot's replies to STOP and reports them; a silent robot does not delay reports of the other."""

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
        """Report all by the reply to the newest: waiting for each of them at a frozen robot would take ever longer."""
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


class Stopping:
    """A thread that sends STOP to both robots, the hardware first."""

    def __init__(
        self,
        robots: Callable[[], tuple[Robot, ...]],
        no_session: Callable[[int], Outcome],
        report: Callable[[Outcome], None],
    ) -> None:
        """Start the thread.

        Args:
            robots: returns hardware and simulation; empty without a session.
            no_session: returns the outcome of a row without a session.
            report: takes outcomes.
        """
        self._robots, self._no_session, self._report = robots, no_session, report
        self._sent = 0
        self._wakeup = Wakeup()
        self._rows: queue.SimpleQueue[int | None] = queue.SimpleQueue()
        self._rests = {twin: StopReplies(twin, report) for twin in ("hw", "sim")}
        self._thread = threads.start(self._run, "window-stop")

    def press(self, row: int) -> None:
        """Send STOP now; returns when it was sent, after YIELD_S at the latest."""
        before = self._sent
        self._rows.put(row)
        # Otherwise Python would run this thread for 5 ms before it switches to the other one.
        self._wakeup.wait_for(lambda: self._sent != before, YIELD_S)

    def _run(self) -> None:
        while (row := self._rows.get()) is not None:
            try:
                self._send(row)
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

    def close(self) -> None:
        """End; returns at once."""
        self._rows.put(None)
        for rest in self._rests.values():
            rest.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the threads until `deadline_s` (monotonic clock, s)."""
        self._thread.join(max(0.0, deadline_s - time.monotonic()))
        for rests in self._rests.values():
            rests.join(deadline_s)
