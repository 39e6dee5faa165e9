"""The recorder's thread, which converts publications to rows and passes them to the outputs."""

from __future__ import annotations

import threading
import time
from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh._generated.messages import Event, Positions, Status
from beatrix_zenoh.client.camera import CameraImage
from beatrix_zenoh.client.request import Place
from beatrix_zenoh.client.robot_state import LOST_S
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.recording.difference import Difference
from beatrix_zenoh.recording.figure import Figure
from beatrix_zenoh.recording.output import Output, RobotSet, Say
from beatrix_zenoh.recording.robot_queries import RobotAnswer, RobotQueries
from beatrix_zenoh.recording.robot_rows import RobotRows
from beatrix_zenoh.recording.rows import RECORDER, Frame, Line, Numbers, Row, of_difference, of_robot
from beatrix_zenoh.recording.subscriptions import RobotSubscriptions, Value
from beatrix_zenoh.recording.timebase import Timebase

PERIOD_S: Final = 0.05
WAITING: Final = 500
"""Publications of a robot that are kept until its clock offset is known; if more arrive, the oldest are
dropped and counted."""
REPORT_S: Final = 5.0
END_S: Final = 15.0
"""The longest time that `close` waits for a disk or a viewer."""
UNKNOWN_NS: Final = 1_000_000_000
"""Assumed error of a clock offset that was estimated from arrival times."""


class RecordingThread:
    """Converts new publications to rows 20 times a second, and passes the rows to the outputs."""

    def __init__(
        self,
        subscriptions: RobotSubscriptions,
        queries: RobotQueries,
        outputs: Sequence[Output],
        say: Say,
        cameras_hz: float,
    ) -> None:
        self._subscriptions, self._queries, self._outputs, self._say = subscriptions, queries, outputs, say
        self._picture_period_ns = round(1e9 / cameras_hz) if cameras_hz else 0
        self._timebase = Timebase(time.monotonic_ns(), time.time_ns())
        self._rows: dict[Place, RobotRows] = {}
        self._differences: defaultdict[str, Difference] = defaultdict(Difference)
        self._waiting: dict[Place, deque[Arrival[Value]]] = {}
        self._last: dict[Place, tuple[int, int]] = {}
        """Newest positions of each robot (ns): arrival by our monotonic clock, and time by our wall clock."""
        self._picture_due_ns: dict[str, int] = {}
        self._with_pictures: frozenset[Place] = frozenset()
        self._overflowed = self._wrong_times = self._reported = 0
        self._reported_s = 0.0
        self.samples = 0
        """Number of positions that were converted."""
        self.failure: Exception | None = None
        """The exception that has ended the thread, if any."""
        self._ending = threading.Event()
        self._thread = threads.start(self._run, "recorder")

    @property
    def dropped(self) -> int:
        """Number of publications that were not written: they arrived too fast, or their time stamps were impossible."""
        return self._subscriptions.dropped + self._overflowed + self._wrong_times

    @property
    def robots(self) -> list[Place]:
        """Robots in the recording so far."""
        return sorted(self._rows)

    def close(self) -> bool:
        """Write the publications that have arrived, and close all outputs; return False if an output does not close."""
        self._ending.set()
        self._thread.join(END_S)
        if self._thread.is_alive():
            return False
        closed = [output.close() for output in self._outputs]
        return all(closed)

    def _run(self) -> None:
        try:
            while not self._ending.wait(PERIOD_S):
                self._step()
            self._step()
        except Exception as error:  # noqa: BLE001 # the main thread reports it and ends
            self.failure = error

    def _step(self) -> None:
        rows: list[Row] = []
        for answer in self._queries.answers():
            rows += self._answered(answer)
        for arrival in self._subscriptions.take():
            rows += self._arrived(arrival)
        rows += self._lost_robots()
        now_s = time.monotonic()
        rows += self._dropped_rows(now_s)
        for output in self._outputs:
            output.write(rows)
        restarted = [output.update(now_s) for output in self._outputs]
        if any(restarted):
            for rows_of_robot in self._rows.values():
                rows_of_robot.begin_again()

    def _arrived(self, arrival: Arrival[Value]) -> Iterator[Row]:
        """Yield the rows of a publication, or keep it while the robot's clock offset is unknown."""
        place = arrival.robot, arrival.twin
        known = self._timebase.knows(place)
        if known and isinstance(arrival.value, Positions) and not self._fits(place, arrival):
            self._timebase.forget(place)
        if self._timebase.knows(place):
            yield from self._convert(place, arrival)
            return
        if place not in self._waiting:
            self._waiting[place] = deque(maxlen=WAITING)
            self._queries.request(place)
        self._overflowed += len(self._waiting[place]) == WAITING
        self._waiting[place].append(arrival)

    def _answered(self, answer: RobotAnswer) -> Iterator[Row]:
        """Use the answer of a robot; yield the rows of the publications that were kept until then."""
        place, waiting = answer.place, self._waiting.pop(answer.place, ())
        if answer.offset is not None:
            self._timebase.learn(place, answer.offset.offset_ns, answer.offset.bound_ns)
        elif waiting:
            # The robot publishes without answering: the fastest publication gives the best estimate.
            offset_ns = max(arrival.value.t_mono_ns - arrival.t_mono_ns for arrival in waiting)
            self._timebase.learn(place, offset_ns, UNKNOWN_NS)
        if place not in self._rows:
            self._rows[place] = RobotRows(place, Figure(answer.geometry))
            self._show_robots()
        for arrival in waiting:
            yield from self._convert(place, arrival)

    def _show_robots(self) -> None:
        robots = RobotSet({place: rows.figure for place, rows in self._rows.items()}, self._with_pictures)
        for output in self._outputs:
            output.show(robots)

    def _fits(self, place: Place, arrival: Arrival[Value]) -> bool:
        """Return whether the time stamps of a publication are possible.

        Rows with wrong times would make the recording useless.
        """
        value = arrival.value
        return value.t_wall_ns >= 0 and self._timebase.fits(place, value.t_mono_ns, arrival.t_mono_ns)

    def _convert(self, place: Place, arrival: Arrival[Value]) -> Iterator[Row]:
        if not self._fits(place, arrival):
            self._wrong_times += 1
            return
        value, rows = arrival.value, self._rows[place]
        time_ns = self._timebase.time_ns(place, value.t_mono_ns)
        match value:
            case Positions():
                self.samples += 1
                self._last[place] = arrival.t_mono_ns, time_ns
                yield from rows.back(time_ns, value.t_wall_ns)
                yield from rows.positions(value, time_ns)
                yield from self._difference(place, rows, time_ns, value.t_wall_ns)
            case Status():
                yield from rows.status(value, time_ns)
            case Event():
                yield from rows.event(value, time_ns)
            case CameraImage():
                yield from self._picture(place, value, time_ns)

    def _difference(self, place: Place, rows: RobotRows, time_ns: int, robot_ns: int) -> Iterator[Row]:
        for difference in self._differences[place[0]].add(place[1], time_ns, rows.angles):
            for what, angles in (("arms", difference.angles[:3]), ("head", difference.angles[3:])):
                yield Numbers(of_difference(place[0], what), difference.time_ns, robot_ns, angles)

    def _picture(self, place: Place, image: CameraImage, time_ns: int) -> Iterator[Row]:
        """Yield the row of a picture if one is due."""
        path = of_robot(place, "camera", image.eye)
        due_ns = self._picture_due_ns.get(path, time_ns)
        # Accept a slightly early picture: otherwise a camera of 15 Hz would give 3.75 Hz instead of 5 Hz.
        if time_ns < due_ns - self._picture_period_ns // 8:
            return
        self._picture_due_ns[path] = max(due_ns, time_ns - self._picture_period_ns) + self._picture_period_ns
        if place not in self._with_pictures:
            self._with_pictures |= {place}
            self._show_robots()
        yield Frame(path, time_ns, image.t_wall_ns, image.jpeg)

    def _lost_robots(self) -> Iterator[Row]:
        """Yield the state LOST of each robot that no longer publishes positions."""
        now_ns = time.monotonic_ns()
        for place, (arrived_ns, time_ns) in self._last.items():
            if now_ns - arrived_ns > LOST_S * 1e9:
                yield from self._rows[place].lost(time_ns)

    def _dropped_rows(self, now_s: float) -> Iterator[Row]:
        """Report newly dropped publications to the user, at most every REPORT_S; yield a log line and a count."""
        dropped = self.dropped
        if dropped == self._reported or now_s < self._reported_s + REPORT_S:
            return
        self._reported, self._reported_s = dropped, now_s
        text = (
            f"{dropped} publications were dropped so far: they arrive faster than this computer writes them."
        )
        if self._wrong_times:
            text = (
                f"{dropped} publications were dropped so far, "
                f"{self._wrong_times} of them with impossible time stamps."
            )
        self._say(text)
        time_ns = self._timebase.own_ns(time.monotonic_ns())
        yield Line(f"{RECORDER}/log", time_ns, time_ns, text, "WARN")
        yield Numbers(f"{RECORDER}/dropped", time_ns, time_ns, (float(dropped),))
