"""STOP on a thread of its own, which waits for nothing else."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from beatrix_zenoh import threads
from beatrix_zenoh._generated.messages import CommandReply
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.group_stop import STOP_S, request_stop
from beatrix_zenoh.client.request import GroupRequest
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.web.messages import Outcome, refused

REPLIES_MAX: Final = 16
"""Largest number of STOPs whose replies are awaited at the same time; replies to further STOPs are not reported."""
NO_REPLY: Final = "STOP was sent. {} did not answer: if it moves, switch its power off."

Report = Callable[[Outcome], object]
"""Takes the outcome of STOP for each robot. Called on threads of `Stopping`."""


class Press(NamedTuple):
    """A STOP to send; waiting presses for the same robot are sent as one STOP."""

    clients: Sequence[Client]
    """sessions for sending: the first one that is connected is used, else the last"""
    robot: str
    reports: list[Report]


class Sent(NamedTuple):
    """A STOP that was sent."""

    press: Press
    request: GroupRequest[CommandReply]


class Stopping:
    """Sends STOP to simulation and hardware of a name on one thread, and waits for the replies on another."""

    def __init__(self) -> None:
        self._wake = threading.Condition()
        self._waiting: dict[str, Press] = {}
        """Waiting presses, one for each robot, so that many presses for one robot do not delay STOP for the others."""
        self._closed = False
        self._sent: queue.Queue[Sent | None] = queue.Queue(REPLIES_MAX)
        self._threads: list[threading.Thread] = [
            threads.start(self._send_all, "web-stop"),
            threads.start(self._report_all, "web-stop-replies"),
        ]

    def press(self, clients: Sequence[Client], robot: str, report: Report) -> None:
        """Queue STOP for the sending thread, without waiting."""
        with self._wake:
            press = self._waiting.setdefault(robot, Press(clients, robot, []))
            if len(press.reports) < REPLIES_MAX:
                press.reports.append(report)
            self._wake.notify()

    def _next(self) -> Press | None:
        """Wait for a press and return the oldest one; None after `close`, when none is left."""
        with self._wake:
            self._wake.wait_for(lambda: self._waiting or self._closed)
            return self._waiting.pop(next(iter(self._waiting))) if self._waiting else None

    def _send_all(self) -> None:
        while (press := self._next()) is not None:
            connected = [client for client in press.clients if client.bus.connected]
            try:
                sent = Sent(press, request_stop((connected or press.clients[-1:])[0], press.robot))
            except BeatrixError as error:
                report_to(press, refused("stop", error.message))
                continue
            with contextlib.suppress(queue.Full):
                self._sent.put_nowait(sent)
        self._sent.put(None)

    def _report_all(self) -> None:
        while (sent := self._sent.get()) is not None:
            replies = list(sent.request.replies(STOP_S))
            for (_, twin), reply in replies:
                text = f"{sent.press.robot} ({twin}): {reply.message}"
                report_to(sent.press, Outcome("stop", ok=reply.result, text=text))
            if not replies:
                report_to(sent.press, refused("stop", NO_REPLY.format(sent.press.robot)))

    def close(self) -> None:
        """Send the waiting STOPs and end the threads; wait at most STOP_S."""
        with self._wake:
            self._closed = True
            self._wake.notify()
        deadline_s = time.monotonic() + STOP_S
        for thread in self._threads:
            thread.join(max(0.0, deadline_s - time.monotonic()))


def report_to(press: Press, outcome: Outcome) -> None:
    """Report an outcome to the pages that pressed STOP."""
    for report in press.reports:
        report(outcome)
