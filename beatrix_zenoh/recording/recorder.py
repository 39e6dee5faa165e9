"""The recorder: writes the publications of robots to files, viewers, or both."""

from __future__ import annotations

import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.body.figure import Figure, geometry_of
from beatrix_zenoh.client.monitor import LOST_S
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.sound import Sound
from beatrix_zenoh.client.subscription import CameraImage
from beatrix_zenoh.contract._generated.messages import Event, Positions, Status
from beatrix_zenoh.recording.losses import POSITIONS, Count, Losses, LossReport, Stream
from beatrix_zenoh.recording.outputs import Output
from beatrix_zenoh.recording.rows import (
    Difference,
    Frame,
    Numbers,
    RecordingRow,
    RobotRows,
    RobotSet,
    Say,
    of_difference,
    of_robot,
)
from beatrix_zenoh.recording.samples import About, Note, about
from beatrix_zenoh.recording.sound import rows_of as rows_of_sound
from beatrix_zenoh.recording.sources import (
    AGAIN_S,
    NoteInbox,
    RobotAnswer,
    RobotQueries,
    RobotSubscriptions,
    Timebase,
    Timed,
    TimedArrivals,
    rows_of,
)

PERIOD_S: Final = 0.05
END_S: Final = 15.0
"""The longest time that `close` waits for a disk or a viewer."""


class Recorder:
    """Converts new publications to rows 20 times a second, in a thread of its own, and passes the rows to the outputs.

    Robots may come and go. Memory is bounded: publications that arrive faster than they are written are dropped, the
    oldest first, and counted.
    """

    def __init__(
        self,
        subscriptions: RobotSubscriptions,
        queries: RobotQueries,
        outputs: Sequence[Output],
        say: Say,
        cameras_hz: float,
        about: About,
        notes: NoteInbox | None = None,
    ) -> None:
        """Start; `start_recording` says what the arguments are. `close` closes all of them."""
        self._subscriptions, self._queries, self._outputs = subscriptions, queries, outputs
        self._picture_period_ns = round(1e9 / cameras_hz) if cameras_hz else 0
        self._timebase = Timebase(time.monotonic_ns(), time.time_ns())
        self._losses = Losses()
        self._arrivals = TimedArrivals(self._timebase, queries, self._losses)
        self._report = LossReport(say)
        self._rows: dict[Place, RobotRows] = {}
        self._about, self._notes = about, notes
        for output in outputs:
            output.describe(about)
        self._differences: defaultdict[str, Difference] = defaultdict(Difference)
        self._last: dict[Place, tuple[int, int]] = {}
        """Newest positions of each robot (ns): arrival by our monotonic clock, and time by our wall clock."""
        self._picture_due_ns: dict[str, int] = {}
        self._shown = RobotSet({})
        self._measure_s = time.monotonic() + AGAIN_S
        self.samples = 0
        """Number of positions that were converted."""
        self._failure: Exception | None = None
        self._closed: bool | None = None
        self._ending = threading.Event()
        self._thread = threads.start(self._run, "recorder")

    @property
    def counts(self) -> dict[Stream, Count]:
        """Publications of each stream: received, lost, dropped, late."""
        return self._losses.counts(self._subscriptions.dropped)

    @property
    def robots(self) -> list[Place]:
        """Robots in the recording so far."""
        return sorted(self._rows)

    def check(self) -> None:
        """Raise the exception that has ended the thread, if any."""
        if self._failure is not None:
            raise self._failure

    def close(self) -> bool:
        """Write the publications that have arrived, and close all outputs; return False if an output does not close."""
        if self._closed is None:
            if self._notes is not None:
                self._notes.close()
            self._ending.set()
            self._thread.join(END_S)
            closed = [not self._thread.is_alive() and output.close() for output in self._outputs]
            self._closed = all(closed)
            self._subscriptions.close()
            self._queries.close()
        return self._closed

    def _run(self) -> None:
        try:
            while not self._ending.wait(PERIOD_S):
                self._step()
            self._step(last=True)
        except Exception as error:  # noqa: BLE001 # the main thread reports it and ends
            self._failure = error

    def _step(self, *, last: bool = False) -> None:
        rows: list[RecordingRow] = []
        if time.monotonic() >= self._measure_s:
            self._measure_s = time.monotonic() + AGAIN_S
            for place in self._rows:
                self._queries.request(place)
        for answer in self._queries.answers():
            rows += self._answered(answer)
        for arrival in self._subscriptions.take():
            for timed in self._arrivals.arrived(arrival):
                rows += self._convert(timed)
        rows += self._noted()
        rows += self._lost_robots()
        now_s = time.monotonic()
        rows += self._report.lines(self.counts, self._timebase.own_ns(time.monotonic_ns()), now_s, last=last)
        for output in self._outputs:
            output.write(rows)
        restarted = [output for output in self._outputs if output.update(now_s)]
        for output in restarted:
            output.show(self._shown)
            output.describe(self._about)
        if restarted:
            again = [row for rows_of_robot in self._rows.values() for row in rows_of_robot.begin_again()]
            for output in self._outputs:
                output.write(again)

    def _answered(self, answer: RobotAnswer) -> Iterator[RecordingRow]:
        """Use the answer of a robot; yield the rows of the publications that were kept until then."""
        waiting = list(self._arrivals.answered(answer))
        if answer.place not in self._rows:
            own = answer.info.geometry if answer.info is not None else None
            figure = Figure(geometry_of(own)) if own is not None else Figure()
            self._rows[answer.place] = RobotRows(answer.place, figure)
            self._show(replace(self._shown, robots={**self._shown.robots, answer.place: figure}))
        if answer.info is not None:
            self._describe(self._about.with_robot(answer.place, answer.info))
        if answer.offset is not None:
            now_ns = self._timebase.own_ns(time.monotonic_ns())
            yield from self._rows[answer.place].clock(now_ns, *answer.offset)
        for timed in waiting:
            yield from self._convert(timed)

    def _noted(self) -> Iterator[RecordingRow]:
        """Yield the rows of new notes."""
        for seat, text, mono_ns in self._notes.take() if self._notes is not None else ():
            self._describe(self._about.with_seat(seat))
            yield from rows_of(Note(self._timebase.own_ns(mono_ns), seat, text))

    def _describe(self, about: About) -> None:
        """Let the outputs say what is new about the recording."""
        if about != self._about:
            self._about = about
            for output in self._outputs:
                output.describe(about)

    def _show(self, robots: RobotSet) -> None:
        """Let the outputs show what is new about the robots."""
        if robots != self._shown:
            self._shown = robots
            for output in self._outputs:
                output.show(robots)

    def _convert(self, timed: Timed) -> Iterator[RecordingRow]:
        arrival, time_ns, stale = timed
        place, value = (arrival.robot, arrival.side), arrival.value
        rows = self._rows[place]
        match value:
            case Positions():
                self._last[place] = arrival.t_mono_ns, time_ns
                yield from rows.back(time_ns)
                if rows.repeats(value, stale=stale):
                    self._losses.count((place, POSITIONS)).repeated += 1
                    return
                self.samples += 1
                yield from rows.positions(value, time_ns)
                yield from self._difference(place, rows, time_ns)
            case Status():
                yield from rows.status(value, time_ns)
            case Event():
                self._describe(self._about.with_seat(value.seat))
                yield from rows.event(value, time_ns)
            case CameraImage():
                yield from self._picture(place, value, time_ns)
            case Sound():
                self._show(replace(self._shown, with_sound=self._shown.with_sound | {place}))
                yield from rows_of_sound(place, value, time_ns)

    def _difference(self, place: Place, rows: RobotRows, time_ns: int) -> Iterator[RecordingRow]:
        for grid_ns, angles in self._differences[place[0]].add(place[1], time_ns, rows.angles):
            yield Numbers(of_difference(place[0], "arms"), grid_ns, angles[:3])
            yield Numbers(of_difference(place[0], "head"), grid_ns, angles[3:])

    def _picture(self, place: Place, image: CameraImage, time_ns: int) -> Iterator[RecordingRow]:
        """Yield the row of a picture if one is due."""
        path = of_robot(place, "camera", image.eye)
        due_ns = self._picture_due_ns.get(path, time_ns)
        # Accept a slightly early picture: otherwise a camera of 15 Hz would give 3.75 Hz instead of 5 Hz.
        if time_ns < due_ns - self._picture_period_ns // 8:
            return
        self._picture_due_ns[path] = max(due_ns, time_ns - self._picture_period_ns) + self._picture_period_ns
        self._show(replace(self._shown, with_pictures=self._shown.with_pictures | {place}))
        yield Frame(path, time_ns, image.jpeg)

    def _lost_robots(self) -> Iterator[RecordingRow]:
        """Yield the state LOST of each robot that no longer publishes positions."""
        now_ns = time.monotonic_ns()
        for place, (arrived_ns, time_ns) in self._last.items():
            if now_ns - arrived_ns > LOST_S * 1e9:
                yield from self._rows[place].lost(time_ns)


@dataclass(frozen=True)
class RecordingOptions:
    """What is recorded."""

    names: Sequence[str]
    """names of robots; empty: all robots"""
    cameras_hz: float
    """pictures per second of each eye; 0: no pictures"""
    sound: bool = False
    """whether to switch the microphones of the robots on, and to record what they hear"""
    title: str = ""
    """empty: the name of the file"""
    note: str = ""
    """what the user writes about the recording"""


def start_recording(
    client: Client,
    outputs: Sequence[Output],
    say: Say,
    options: RecordingOptions,
    file: Callable[[], str] | None = None,
) -> Recorder:
    """Start recording.

    Args:
        client: the session.
        outputs: files and viewers that get the rows.
        say: shows a sentence to the user; called by the recorder's own thread.
        options: what is recorded.
        file: returns the name of the present file; the recorder then takes notes of all seats. None: it takes none.

    Raises:
        WrongUsage: the client was closed.
    """
    subscriptions = RobotSubscriptions(
        client, options.names, cameras=options.cameras_hz > 0, microphones=options.sound
    )
    queries = RobotQueries(client)
    facts = about(time.time_ns(), title=options.title, note=options.note, seat=client.settings.who)
    notes = None if file is None else NoteInbox(client, file, options.title)
    if notes is not None and options.note:
        notes.add(client.settings.who, options.note)
    return Recorder(subscriptions, queries, outputs, say, options.cameras_hz, facts, notes)
