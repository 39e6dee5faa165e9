"""Counts the publications of each robot and stream (received, lost on the way, dropped here, late), and reports them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Final

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.subscription import CameraImage
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Positions, Status
from beatrix_zenoh.contract.publishers import Order, Publishers
from beatrix_zenoh.recording.rows import RECORDER, Line, Say

if TYPE_CHECKING:  # importing numpy would delay `beatrix record --help`
    from beatrix_zenoh.client.sound import Sound

POSITIONS: Final = "positions"
EVENTS: Final = "events"
STATES: Final = "states"
PICTURES: Final = "pictures of the"
"""Beginning of the kinds of pictures."""
SOUND: Final = "blocks of sound"
CONTESTED: Final = "contested"
"""The cause of a sentence that has no number."""
_KINDS: Final = {"positions": POSITIONS, "events": EVENTS, "status": STATES, "microphones": SOUND}

Stream = tuple[Place, str]
"""A robot, and one kind of its publications, as in sentences: `positions`, `events`, `pictures of the left eye`."""


@dataclass
class Count:
    """The publications of one stream since its first one that was received."""

    received: int = 0
    """publications that this recorder has received and read"""
    lost: int = 0
    """numbers that are missing although no queue of this recorder dropped them"""
    dropped: int = 0
    """publications that arrived and were dropped, because this computer was too slow"""
    impossible: int = 0
    """received publications that were left out: their time stamps cannot be right"""
    late: int = 0
    """received publications that arrived more than 2 s after the time in their stamps"""
    repeated: int = 0
    """received positions that repeat those before them, because the node had no new telemetry"""
    contested: int = 0
    """streams of a robot for which two programs publish, so that lost publications cannot be counted: 0 or 1"""

    @property
    def published(self) -> int:
        """Number of publications that the robot has made since the first one that was received."""
        return self.received + self.lost + self.dropped

    @property
    def unwritten(self) -> int:
        """Number of publications that this recorder left out."""
        return self.dropped + self.impossible

    def __add__(self, other: Count) -> Count:
        return Count(*(getattr(self, one.name) + getattr(other, one.name) for one in fields(self)))


class Losses:
    """Finds missing sequence numbers, and counts what happened to the publications of each stream.

    A subscription that begins late misses nothing: counting begins with the first number. Numbers of a node that was
    restarted begin again, and a uint32 begins again at 0; neither is a loss.
    """

    def __init__(self) -> None:
        self._counts: defaultdict[Stream, Count] = defaultdict(Count)
        self._orders: defaultdict[Stream, Order] = defaultdict(Order)
        self._publishers: defaultdict[Place, Publishers] = defaultdict(Publishers)
        self._contested: set[Place] = set()

    def received(self, stream: Stream, seq: int | None) -> None:
        """Count a publication that was received; `seq` is None if publications of this kind have no number."""
        self._counts[stream].received += 1
        if seq is None:
            return
        if stream[1] == POSITIONS and self._publishers[stream[0]].several(seq):
            self._contested.add(stream[0])
        if self._orders[stream].goes_back(seq) and stream[1] == POSITIONS:
            # The node was restarted: its positions show it first, and all its numbers begin again.
            for (place, kind), other in self._orders.items():
                if place == stream[0] and kind != POSITIONS:
                    other.restart()

    def count(self, stream: Stream) -> Count:
        """Return the counts of a stream, to be changed; `lost`, and what the subscriptions dropped, are not in them."""
        return self._counts[stream]

    def overflowed(self, stream: Stream) -> None:
        """Count a received publication that was dropped while the robot's clock offset was unknown."""
        count = self._counts[stream]
        count.received -= 1
        count.dropped += 1

    def counts(self, dropped: Mapping[Stream, int]) -> dict[Stream, Count]:
        """Return the counts of each stream; `dropped`: publications that the subscriptions have dropped."""
        found = {}
        for stream in sorted({*self._counts, *dropped}):
            contested, here = stream[0] in self._contested, dropped.get(stream, 0)
            missing = self._orders[stream].missing - here  # what was dropped here was not lost on the way
            one = self._counts.get(stream, Count()) + Count(dropped=here, contested=int(contested))
            found[stream] = replace(one, lost=0 if contested else max(0, missing))
        return found


def stream_of(place: Place, value: Positions | Status | Event | CameraImage | Sound) -> Stream:
    """Return the stream of a publication."""
    match value:
        case Positions():
            return place, POSITIONS
        case Event():
            return place, EVENTS
        case CameraImage():
            return place, pictures_of(value.eye)
        case Status():
            return place, STATES
    return place, SOUND


def stream_of_key(key: str) -> Stream | None:
    """Return the stream of a publication's key; None: the recorder does not subscribe to such keys."""
    parts = keys.parse(key)
    what = "" if parts is None else {**_KINDS, "camera": pictures_of(parts.eye)}.get(parts.row, "")
    return ((parts.robot, parts.side), what) if parts is not None and what else None


def pictures_of(eye: str) -> str:
    """Return the kind of a camera's publications."""
    return f"{PICTURES} {names.view_title(eye)}"


def seq_of(value: Positions | Status | Event | CameraImage | Sound) -> int | None:
    """Return the sequence number of a publication; None: it has none."""
    return None if isinstance(value, Status) else value.seq


def total(counts: Mapping[Stream, Count]) -> Count:
    """Return the sum of all streams."""
    return sum(counts.values(), Count())


def findings(counts: Mapping[Stream, Count]) -> dict[tuple[Stream, str], str]:
    """Return a sentence for each stream and each cause (a field of Count) for which publications are missing or late."""
    found = {}
    for stream, one in counts.items():
        (name, side), what = stream
        if one.contested and what == POSITIONS:
            found[stream, CONTESTED] = (
                f"Two programs publish the positions of {name} ({side}), so lost ones cannot be counted. End one of them."
            )
        limited = " or left out by a router that limits pictures" * what.startswith(PICTURES)
        for cause, outcome in {
            "lost": f"were lost on the network{limited}",
            "dropped": "were dropped here: this computer was too slow",
            "impossible": "have impossible time stamps and were left out",
            "late": "arrived more than 2 s late; they have their true times",
        }.items():
            number = getattr(one, cause)
            if number:
                found[stream, cause] = f"{name} ({side}): {number} of {one.published} {what} {outcome}."
    return found


LASTS_S: Final = 1.0
"""Time (s) for which a cause must be there before the user reads it: the numbers of two programs look like losses first."""
LOG: Final = f"{RECORDER}/log"


class LossReport:
    """Reports each stream and cause once, LASTS_S after it occurs, and again with its final number."""

    def __init__(self, say: Say) -> None:
        self._say = say
        self._reported: set[tuple[Stream, str]] = set()
        self._since_s: dict[tuple[Stream, str], float] = {}

    def lines(
        self, counts: Mapping[Stream, Count], time_ns: int, now_s: float, *, last: bool
    ) -> Iterator[Line]:
        """Show the user what is new, and yield its lines of the log.

        Args:
            counts: the publications so far.
            time_ns: time of the lines by the recorder's wall clock.
            now_s: the recorder's monotonic clock.
            last: the recording ends: yield the final numbers; the user reads them in the summary.
        """
        found = findings(counts)
        self._since_s = {key: self._since_s.get(key, now_s) for key in found}
        for key, text in found.items():
            contested, known = key[1] == CONTESTED, key in self._reported
            if last and not (contested and known):
                yield Line(LOG, time_ns, text, "WARN")
            elif not (last or known) and now_s - self._since_s[key] >= LASTS_S:
                self._reported.add(key)
                so_far = text if contested else f"So far: {text}"
                self._say(so_far)
                yield Line(LOG, time_ns, so_far, "WARN")
