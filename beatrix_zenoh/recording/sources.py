"""What the recorder receives: publications with their times by its own clock, answers to its queries, and users' notes."""

from __future__ import annotations

import queue
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final, NamedTuple

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.bus.query_forms import read
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.robot_base import Offset, clock_offsets
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.sound import Sound, sound
from beatrix_zenoh.client.subscription import (
    Arrival,
    CameraImage,
    Subscription,
    events,
    images,
    positions,
    status,
)
from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Event,
    Info,
    NoteQuery,
    NoteReply,
    Positions,
    Reason,
    Status,
)
from beatrix_zenoh.contract.codec import encode_json
from beatrix_zenoh.contract.errors import BeatrixError, Refused, bad_value
from beatrix_zenoh.contract.names import EYES
from beatrix_zenoh.recording.losses import Losses, Stream, seq_of, stream_of, stream_of_key
from beatrix_zenoh.recording.rows import MARK, NOTES, Bar, Line, RecordingRow, clock
from beatrix_zenoh.recording.samples import Note

Value = Positions | Status | Event | CameraImage | Sound
PICTURES: Final = 64
"""Length of the queue of one camera: about 5 MB."""
BLOCKS: Final = 3000
"""Length of the queue of sound: 60 s of one robot, 12 MB."""


class RobotSubscriptions:
    """Subscriptions to all robots, or to those with given names.

    Zenoh's threads only enqueue undecoded publications. Each queue is bounded: 3000 publications of each kind, 64
    pictures of each camera.
    """

    def __init__(self, client: Client, names: Sequence[str], *, cameras: bool, microphones: bool) -> None:
        """Subscribe to the robots of these names, or to all robots if no name is given.

        With `cameras`, robots capture pictures for this recorder; with `microphones`, they switch their microphones on.
        """
        self._subscriptions: list[
            Subscription[Positions]
            | Subscription[Status]
            | Subscription[Event]
            | Subscription[CameraImage]
            | Subscription[Sound]
        ] = []
        for name in names or ["*"]:
            self._subscriptions += [
                status(client, name, timeout_s=None),
                events(client, name),
                positions(client, name, timeout_s=None),
            ]
            if cameras:
                self._subscriptions += [
                    images(client, name, "*", eye, timeout_s=None, length=PICTURES) for eye in EYES
                ]
            if microphones:
                key = keys.microphones(name, "*")
                self._subscriptions.append(
                    Subscription(client, key, sound, timeout_s=None, length=BLOCKS, bus=client.media)
                )

    def take(self) -> list[Arrival[Value]]:
        """Return all publications since the last call, in the order of arrival."""
        arrivals: list[Arrival[Value]] = [
            arrival for subscription in self._subscriptions for arrival in subscription.take_arrivals()
        ]
        return sorted(arrivals, key=lambda arrival: arrival.t_mono_ns)

    @property
    def dropped(self) -> dict[Stream, int]:
        """Number of publications of each stream that were dropped because they were not taken in time."""
        found: dict[Stream, int] = {}
        for subscription in self._subscriptions:
            for key, dropped in subscription.dropped_keys.items():
                if (stream := stream_of_key(key)) is not None:
                    found[stream] = found.get(stream, 0) + dropped
        return found

    def close(self) -> None:
        """End the subscriptions."""
        for subscription in self._subscriptions:
            subscription.close()


AGAIN_S: Final = 30.0
"""Period of the queries: clocks of two computers drift apart by up to about 0.1 ms/s, which is 3 ms in this time."""
ANSWER_S: Final = 1.0


@dataclass(frozen=True)
class RobotAnswer:
    """Clock offset and description of a robot."""

    place: Place
    offset: Offset | None = None
    """offset of the robot's monotonic clock; None: the robot did not answer"""
    info: Info | None = None
    """what the robot says of itself; None: it did not answer"""


class RobotQueries:
    """Queries robots one after the other, without blocking the recorder."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._requests: queue.SimpleQueue[Place | None] = queue.SimpleQueue()
        self._answers: deque[RobotAnswer] = deque()
        self._thread = threads.start(self._run, "recorder-queries")

    def request(self, place: Place) -> None:
        """Queue a query of a robot."""
        self._requests.put(place)

    def answers(self) -> list[RobotAnswer]:
        """Return the answers since the last call."""
        return [self._answers.popleft() for _ in range(len(self._answers))]

    def close(self) -> None:
        """End the thread after its running query."""
        self._requests.put(None)
        self._thread.join()

    def _run(self) -> None:
        for place in iter(self._requests.get, None):
            try:
                offset = clock_offsets(self._client, *place, timeout_s=ANSWER_S).mono
                info = ask(self._client, place, keys.info(*place), None, Info, ANSWER_S)
                self._answers.append(RobotAnswer(place, offset, info))
            except BeatrixError:
                self._answers.append(RobotAnswer(place))


LATE_NS: Final = 2_000_000_000
"""A publication that arrives so long after its time (ns) is late, or the clock of the robot has jumped."""
LATEST_NS: Final = 120_000_000_000
"""The queues of network and recorder hold publications for at most about this time (ns)."""


class Delay(Enum):
    """How the time of a publication relates to its arrival."""

    NONE = auto()
    """less than 2 s before or after it"""
    LATE = auto()
    """the publication was under way for more than 2 s, for example because a computer was busy"""
    IMPOSSIBLE = auto()
    """the time is in the future, or older than any queue can make it"""


class Timebase:
    """Times of samples by the recording computer's clock.

    Both sides use monotonic clocks, so that changes of a wall clock during the recording have no effect. Queries
    measure the offset between them (`clock_offsets`); the wall clock of the recording computer is read once, at the
    beginning.
    """

    def __init__(self, mono_ns: int, wall_ns: int) -> None:
        """Start with the times of both clocks of the recording computer at one moment."""
        self._anchor_ns = wall_ns - mono_ns
        self._offsets: dict[Place, tuple[int, int]] = {}

    def learn(self, place: Place, offset_ns: int, bound_ns: int) -> None:
        """Add a measured offset, robot's clock minus ours; an earlier one that agrees and is more exact is kept.

        Clocks drift apart, so a kept offset gets twice its error bound with each new measurement.
        """
        before = self._offsets.get(place)
        if before is not None and before[1] * 2 < bound_ns and abs(before[0] - offset_ns) <= bound_ns:
            self._offsets[place] = before[0], before[1] * 2
        else:
            self._offsets[place] = offset_ns, bound_ns

    def knows(self, place: Place) -> bool:
        """Return whether the robot's offset is known."""
        return place in self._offsets

    def time_ns(self, place: Place, mono_ns: int) -> int:
        """Convert a time of the robot's monotonic clock to our wall clock; its offset must be known."""
        return mono_ns - self._offsets[place][0] + self._anchor_ns

    def own_ns(self, mono_ns: int) -> int:
        """Convert a time of our monotonic clock to our wall clock."""
        return mono_ns + self._anchor_ns

    def delay(self, place: Place, mono_ns: int, arrived_ns: int) -> Delay:
        """Return how the time of a publication relates to its arrival (our monotonic clock); the offset must be known."""
        delay_ns = arrived_ns - (mono_ns - self._offsets[place][0])
        if -LATE_NS < delay_ns < LATE_NS:
            return Delay.NONE
        return Delay.LATE if LATE_NS <= delay_ns <= LATEST_NS else Delay.IMPOSSIBLE


WAITING: Final = 500
"""Publications of a robot that are kept until its clock offset is known; if more arrive, the oldest are
dropped and counted."""
UNKNOWN_NS: Final = 1_000_000_000
"""Assumed error of a clock offset that was estimated from arrival times."""
CHECKED_NS: Final = 5_000_000_000
"""Time for which a measured clock offset is trusted although times do not fit to it."""


class Timed(NamedTuple):
    """A publication, and the time of its values by the clock of the recording computer, since 1970."""

    arrival: Arrival[Value]
    time_ns: int
    stale: bool = False
    """whether positions repeat others of long ago, because the node gets no telemetry"""


class TimedArrivals:
    """Keeps publications until the clock offset of their robot is known, and has it measured again if times do not fit.

    Counts all publications, and those that are dropped, left out or late.
    """

    def __init__(self, timebase: Timebase, queries: RobotQueries, losses: Losses) -> None:
        self._timebase, self._queries, self._losses = timebase, queries, losses
        self._waiting: dict[Place, deque[Arrival[Value]]] = {}
        self._checked_ns: dict[Place, int] = {}

    def arrived(self, arrival: Arrival[Value]) -> Iterator[Timed]:
        """Yield the publication with its time, or keep it while the clock offset is unknown."""
        place = arrival.robot, arrival.side
        self._losses.received(stream_of(place, arrival.value), seq_of(arrival.value))
        if self._timebase.knows(place):
            yield from self._timed(place, arrival)
            return
        if place not in self._waiting:
            self._waiting[place] = deque()
            self._queries.request(place)
        waiting = self._waiting[place]
        if len(waiting) == WAITING:
            self._losses.overflowed(stream_of(place, waiting.popleft().value))
        waiting.append(arrival)

    def answered(self, answer: RobotAnswer) -> Iterator[Timed]:
        """Use the answer of a robot; yield the publications that were kept until then."""
        place, waiting = answer.place, self._waiting.pop(answer.place, ())
        if answer.offset is not None:
            self._timebase.learn(place, *(round(one * 1e9) for one in answer.offset))
        elif waiting:
            # The robot publishes without answering: the fastest publication gives the best estimate.
            offset_ns = max(arrival.value.t_mono_ns - arrival.t_mono_ns for arrival in waiting)
            self._timebase.learn(place, offset_ns, UNKNOWN_NS)
        for arrival in waiting:
            yield from self._timed(place, arrival)

    def _timed(self, place: Place, arrival: Arrival[Value]) -> Iterator[Timed]:
        """Yield a publication with its time, unless its time stamps are impossible: it would spoil the recording."""
        value = arrival.value
        stream = stream_of(place, value)
        delay = self._timebase.delay(place, value.t_mono_ns, arrival.t_mono_ns)
        if isinstance(value, Positions) and value.repeated and delay is not Delay.NONE:
            yield Timed(arrival, self._timebase.time_ns(place, value.t_mono_ns), stale=True)
            return
        checked_ns = self._checked_ns.get(place, -CHECKED_NS)
        if (
            isinstance(value, Positions)
            and delay is not Delay.NONE
            and arrival.t_mono_ns >= checked_ns + CHECKED_NS
        ):
            # The robot's computer was restarted or slept, or the publication is late: the answer shows which.
            self._checked_ns[place] = arrival.t_mono_ns
            self._queries.request(place)
        if delay is Delay.IMPOSSIBLE or value.t_wall_ns < 0:
            self._losses.count(stream).impossible += 1
            return
        if delay is Delay.LATE:
            self._losses.count(stream).late += 1
        yield Timed(arrival, self._timebase.time_ns(place, value.t_mono_ns))


NOTES_WAITING: Final = 10
"""Notes that may arrive between two steps of the recorder; more are refused, so that a program cannot flood a recording."""
CLOSED: Final = "The recording ends: it takes no more notes."


class Arrived(NamedTuple):
    """A note, and its arrival by the monotonic clock of this computer."""

    seat: str
    text: str
    t_mono_ns: int


class NoteInbox:
    """Takes the notes of all seats while it is open."""

    def __init__(self, client: Client, file: Callable[[], str], title: str) -> None:
        """Answer queries for notes; `file` returns the name of the present file."""
        self._file, self._title = file, printable.label(title)
        self._session = client.bus.session_id
        self._waiting: deque[Arrived] = deque()
        self._closed = False
        client.bus.serve(keys.note("*", self._session), self._receive)

    def take(self) -> list[Arrived]:
        """Return the notes since the last call."""
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

    def close(self) -> None:
        """Refuse further notes."""
        self._closed = True

    def add(self, seat: str, text: str) -> None:
        """Add a note; raises Refused for one that cannot be taken."""
        if not seat:
            raise bad_value(f"A note needs one seat in its key, for example {keys.note('ana', '*')}.")
        line = printable.line(text).strip()
        if not line:
            raise bad_value("The note is empty: give its text.")
        if self._closed:
            raise Refused(Reason.SHUTDOWN, CLOSED)
        if len(self._waiting) >= NOTES_WAITING:
            raise Refused(Reason.BUSY, "Too many notes arrive at once. Send this one again.")
        self._waiting.append(Arrived(seat, line, time.monotonic_ns()))

    def _receive(self, incoming: Incoming) -> None:
        """Answer on Zenoh's thread."""
        parts = keys.parse(incoming.key)
        raw, seat = incoming.raw, "" if parts is None else parts.who
        try:
            self.add(seat, read(raw, NoteQuery).text)
            reason, text = Reason.OK, ""
        except BeatrixError as error:
            reason, text = error.reason, error.message
        reply = NoteReply(
            result=reason is Reason.OK,
            reason=reason,
            message=text,
            file=printable.label(self._file()),
            title=self._title,
            t_wall_ns=time.time_ns(),
        )
        if seat:
            incoming.reply(keys.note(seat, self._session), *raw.answer(reply))
        else:
            incoming.reply_error(*raw.answer(reply))
        incoming.finish()


def rows_of(note: Note) -> Iterator[RecordingRow]:
    """Yield a line of the log, and a mark on the time line that lasts until the next note."""
    text = f"{clock(note.time_ns)}  note by {note.seat}:  {note.text}"
    yield Line(NOTES, note.time_ns, text, "INFO", encode_json(note).decode())
    yield Bar(MARK, note.time_ns, note.text)
