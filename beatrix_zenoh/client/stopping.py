"""STOP as clients send it; all programs, windows and pages use this module.

STOP is published and queried. A foreign queryable may take the query, so STOP is also published, and before the query:
the reply then covers both. Both carry the number of the press, because a robot may receive the publication later, when a
new motion has begun. STOP needs no lease and waits in no queue of requests.

`publish_stop` expects no reply. `stop_robots` sends STOP to several robots at the same time and waits in the caller's
thread. A `StopSender` sends it on a thread of its own, for callers that must not wait.
"""

from __future__ import annotations

import itertools
import os
import queue
import threading
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.client.request import GroupRequest, Request, outcome, publishing, title
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.subscription import Wakeup
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Command,
    CommandQuery,
    CommandReply,
    Detail,
    EventKind,
    Reason,
)
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer

ROBOT_S: Final = 2.0
"""Default time limit (s) of the reply of one robot; the slowest stop, from 90 deg/s, takes half a second."""
GROUP_S: Final = 3.0
"""Time limit (s) of the replies of a group."""
PRESS_BYTES: Final = 8
"""Size of the random number of a press."""
PLACES_MAX: Final = 16
"""Largest number of places whose answers a `StopSender` awaits at the same time; STOP is sent to further ones, too."""
REPORTS_MAX: Final = 256
"""Largest number of stops that one answer is reported for; STOP is sent for further ones, too."""
IF_IT_MOVES: Final = (
    "A robot whose node hangs or has crashed is not online: if it moves, switch its motor power off."
)
"""Advice if no robot was expected to answer."""

Answer = CommandReply | BeatrixError
"""The reply of a robot whose arms rest, or the error of one that refused or did not answer."""
Answers = dict[Place, Answer]
Report = Callable[[Answers], object]
"""Takes the answers of a place; called on a thread of a `StopSender`."""

R = TypeVar("R", bound=RobotBase)


def publish_stop(client: Client, place: Place, press: bytes | None = None) -> None:
    """Publish STOP and expect no reply; in a place `*` stands for all robots or both sides. `press`: its number."""
    client.bus.put(stop_key(client, place), b"", codec.MSGPACK, attachment=press)


def stop_key(client: Client, place: Place) -> str:
    """Return the key of STOP with the seat of a session."""
    return keys.stop(*place, client.settings.who)


def stop_robots(robots: Iterable[R]) -> Iterator[tuple[R, Answer]]:
    """Send STOP to all robots, then wait for each; yield each robot with its answer."""
    sent = [(robot, SentStop(robot.client, robot.place, robot.timeout_s)) for robot in robots]
    for robot, stop in sent:
        yield robot, stop.answer()


def begin_stop(
    client: Client, place: Place, press: bytes, *, emergency: bool
) -> tuple[str, CommandQuery | None, str | None, bytes]:
    """Publish STOP; return key, payload, priority and attachment of its query.

    EMERGENCY_STOP is only queried, as a command. `press`: its number; empty: a new one.
    """
    press = press or os.urandom(PRESS_BYTES)
    if emergency:
        query = CommandQuery(command=Command.EMERGENCY_STOP.value, source=client.source)
        return keys.command(*place, client.settings.who), query, "real_time", press
    publish_stop(client, place, press)
    return stop_key(client, place), None, None, press


class SentStop:
    """STOP or EMERGENCY_STOP that was sent to one robot."""

    def __init__(
        self,
        client: Client,
        place: Place,
        timeout_s: float = ROBOT_S,
        press: bytes = b"",
        *,
        emergency: bool = False,
    ) -> None:
        key, query, priority, press = begin_stop(client, place, press, emergency=emergency)
        self.place, self._timeout_s = place, timeout_s
        self._request = Request(client, place, key, query, timeout_s, priority, press)
        self.close = self._request.close

    def answer(self) -> Answer:
        """Wait until the arms rest; to find why there is no answer takes up to 3 s more."""
        try:
            return outcome(self._request.next(CommandReply, self._timeout_s))
        except BeatrixError as error:
            busy = error.reason is Reason.TIMED_OUT
            return no_answer(self.place, self._timeout_s, publishes=True) if busy else error
        finally:
            self.close()


class SentGroupStop:
    """STOP or EMERGENCY_STOP that was sent to all robots of a place with `*`."""

    def __init__(self, client: Client, place: Place, press: bytes = b"", *, emergency: bool = False) -> None:
        key, query, priority, press = begin_stop(client, place, press, emergency=emergency)
        self._client, self._place = client, place
        self._request = GroupRequest(client, key, query, CommandReply, GROUP_S, priority, press)
        self.close = self._request.close
        self._deadline_s = time.monotonic() + GROUP_S

    def replies(self) -> Answers:
        """Wait until the arms rest; return the answers of the robots that replied within GROUP_S after the STOP."""
        replies = self._request.replies(self._deadline_s - time.monotonic())
        return {place: outcome(reply) for place, reply in replies}

    def answers(self, expected: Iterable[Place]) -> Answers:
        """Return the replies, and an error for each robot of `expected` that is of this group and did not reply."""
        replies = self.replies()
        silent = sorted(place for place in expected if matches(self._place, place) and place not in replies)
        return replies | silences(self._client.bus, silent)


class StopEvents:
    """A subscription to one robot's events since `since_s` (s, the robot's monotonic clock), by default from now on."""

    def __init__(self, robot: RobotBase, since_s: float | None = None) -> None:
        """Subscribe; without `since_s` raises NoAnswer if the robot is not online."""
        self._robot = robot
        self._events = robot.events()
        self._since_s = robot.positions().t if since_s is None else since_s

    def check(self) -> None:
        """Raise Interrupted (STOPPED) if STOP was pressed; its message contains the seat."""
        for event in self._events.take():
            if event.kind is EventKind.STOP and event.t_mono_ns / 1e9 > self._since_s:
                presser = event.seat or "A client"
                raise Interrupted(Reason.STOPPED, f"{self._robot}: {presser} pressed STOP.")

    def close(self) -> None:
        """End the subscription."""
        self._events.close()


def matches(wanted: Place, place: Place) -> bool:
    """Return whether a place with `*` stands for this robot, too."""
    return wanted[0] in ("*", place[0]) and wanted[1] in ("*", place[1])


def sentence(place: Place, message: str) -> str:
    """Return the message of an answer with the name of the robot, unless it begins with it."""
    name = title(place)
    return message if message.startswith(name) else f"{name}: {message}"


def silences(bus: Bus, places: Collection[Place]) -> Answers:
    """Return the errors of robots of a group that did not reply; takes 1 s if one of them publishes no positions."""
    busy = publishing(bus, places) if places else ()
    return {place: no_answer(place, GROUP_S, publishes=place in busy) for place in places}


def no_answer(place: Place, limit_s: float, *, publishes: bool) -> NoAnswer:
    """Return the error of a robot that is online and did not answer STOP within `limit_s` (s)."""
    reason = Reason.TIMED_OUT if publishes else Reason.NODE_HANGS
    return NoAnswer(reason, detail=Detail(field=title(place), value=limit_s, unit="s", needs=["STOP"]))


@dataclass(eq=False)
class QueuedStop:
    """STOP or EMERGENCY_STOP for one place."""

    clients: Sequence[Client]
    place: Place
    emergency: bool
    expected: Collection[Place]
    reports: list[Report]
    """those of all stops that this one stands for"""
    press: bytes
    sent: SentStop | SentGroupStop | None = None

    @property
    def key(self) -> tuple[Place, bool]:
        """Place and `emergency`: one stop stands for others of the same key."""
        return self.place, self.emergency

    def send(self) -> None:
        """Send STOP through the first session that is connected, else through the last."""
        *preferred, last = self.clients
        client = next((client for client in preferred if client.bus.connected), last)
        kind = SentGroupStop if "*" in self.place else SentStop
        self.sent = kind(client, self.place, press=self.press, emergency=self.emergency)

    def stand_for(self, older: QueuedStop | None) -> None:
        """Let the answers of this stop be reported for an older one, too, if there is one."""
        if older is not None:
            self.reports = [*older.reports, *self.reports][:REPORTS_MAX]
            if older.sent is not None:
                older.sent.close()

    def wait(self) -> None:
        """Wait for the answers and report them."""
        assert self.sent is not None
        if isinstance(self.sent, SentStop):
            self.report({self.place: self.sent.answer()})
        else:
            self.report(self.sent.answers(self.expected))

    def report(self, answers: Answers) -> None:
        """Report these answers."""
        for report in self.reports:
            report(answers)


class StopSender:
    """Sends STOP and EMERGENCY_STOP on a thread that waits for nothing else.

    While the answers of a place are awaited it has a thread for them, so that a silent robot delays no other report.
    Stops for one place that queue up are sent as one STOP. Stops while its answers are awaited are sent, too; the
    newest then stands for all of them, because for a silent robot the waits would add up.
    """

    def __init__(self, name: str) -> None:
        """Start the thread for sending, `beatrix-<name>-stop`."""
        self._name = name
        # Callers share no lock with the threads: Ctrl-C in a caller could leave it locked.
        self._queue: queue.SimpleQueue[list[QueuedStop] | None] = queue.SimpleQueue()
        self._batches = 0
        self._sent = Wakeup()
        self._lock = threading.Lock()
        self._awaited: dict[tuple[Place, bool], QueuedStop | None] = {}
        """For each thread for answers, by place and emergency, what it awaits next."""
        self._waiting: list[threading.Thread] = []
        self._sending = threads.start(self._send_all, f"{name}-stop")

    def send(
        self,
        clients: Sequence[Client],
        places: Sequence[Place],
        report: Report,
        expected: Collection[Place] = (),
        yield_s: float = 0.0,
        *,
        emergency: bool = False,
    ) -> None:
        """Send STOP, or EMERGENCY_STOP and to simulations also STOP, to these places, in this order; returns at once.

        Args:
            clients: sessions for sending: the first that is connected is used, else the last.
            places: robots, or groups of robots with `*`.
            report: called for each place.
            expected: robots online; those of a group should answer.
            yield_s: longest time (s) that this thread yields to the thread for sending: otherwise Python may run this
                thread for 5 ms before it switches. Only one thread may use it.
            emergency: whether to send EMERGENCY_STOP.
        """
        before = self._batches
        press = os.urandom(PRESS_BYTES)
        stops = [QueuedStop(clients, place, emergency, expected, [report], press) for place in places]
        if emergency:  # The router of a class does not forward EMERGENCY_STOP to simulations of other seats.
            stops += [
                QueuedStop(clients, (robot, "sim"), emergency=False, expected=(), reports=[], press=press)
                for robot, side in places
                if side != "hw"
            ]
        self._queue.put([*stops])
        if yield_s:
            self._sent.wait_for(lambda: self._batches != before, yield_s)

    def _send_all(self) -> None:
        closed = False
        while not closed:
            batch = [self._queue.get()]
            while not self._queue.empty():
                batch.append(self._queue.get())
            closed = None in batch
            stops: dict[tuple[Place, bool], QueuedStop] = {}
            for stop in itertools.chain.from_iterable(filter(None, batch)):
                stop.stand_for(stops.get(stop.key))
                stops[stop.key] = stop
            sent = [stop for stop in stops.values() if self._guarded(stop, stop.send)]
            self._batches += 1
            self._sent.set()
            for stop in sent:
                self._await(stop)

    def _await(self, stop: QueuedStop) -> None:
        """Let the thread of the place wait for the answers; start it if there is none."""
        assert stop.sent is not None
        with self._lock:
            served = stop.key in self._awaited
            if not served and len(self._awaited) >= PLACES_MAX:
                stop.sent.close()
                return
            stop.stand_for(self._awaited.get(stop.key))
            self._awaited[stop.key] = stop
        if not served:
            self._waiting = [thread for thread in self._waiting if thread.is_alive()]
            self._waiting.append(
                threads.start(lambda: self._report_all(stop.key), f"{self._name}-stop-answers")
            )

    def _report_all(self, key: tuple[Place, bool]) -> None:
        """Report the answers of a place until none is awaited."""
        while True:
            with self._lock:
                stop, self._awaited[key] = self._awaited[key], None
                if stop is None:
                    del self._awaited[key]
                    return
            self._guarded(stop, stop.wait)

    def _guarded(self, stop: QueuedStop, do: Callable[[], None]) -> bool:
        """Call `do` and return whether it succeeded; report its error, because the next STOP must work."""
        try:
            try:
                do()
            except BeatrixError as error:
                stop.report({stop.place: error})
            else:
                return True
        except Exception as error:  # noqa: BLE001
            threads.show_error(error)
        return False

    def close(self) -> None:
        """Send the waiting STOPs and end the threads when the last one is answered; returns at once."""
        self._queue.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the threads until `deadline_s` (monotonic clock, s)."""
        self._sending.join(max(0.0, deadline_s - time.monotonic()))
        for thread in self._waiting:
            thread.join(max(0.0, deadline_s - time.monotonic()))
