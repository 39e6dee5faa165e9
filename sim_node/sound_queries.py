"""The source of sound in the simulated room: what it plays, where it is, and the queries that change it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from beatrix_zenoh.bus import query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import SoundQuery, SoundReply
from beatrix_zenoh.contract.errors import BeatrixError, quoted
from beatrix_zenoh.contract.refusals import bad_field
from beatrix_zenoh.motion.rotation import Vector
from beatrix_zenoh.node import QueryThread
from beatrix_zenoh.node.sensors import FULL_SCALE, RATE
from sim_node.hearing import GENERATORS, PlayingSound, Samples, finer, generated
from sim_node.target import BOUNDS, check_range, check_room, refused, told

SILENCE, SAMPLES = "silence", "samples"
NAMES: Final = (*GENERATORS, SAMPLES, SILENCE)
SECONDS: Final = 3.0
"""Duration if a query gives none."""
SECONDS_MAX: Final = 60.0
SAMPLES_MAX_S: Final = 10.0
"""Longest sound of a client; one Zenoh message must hold it."""
NEAREST: Final = 0.3
"""Smallest allowed distance (m) of a source from the neck's centre: outside the head."""
MOUTH_BELOW_EYES: Final = 0.079
"""Height (m) of the person's eyes above the mouth, as in the model of the room."""


class SoundSource:
    """The source of sound of a room; any thread may read it, and one changes it."""

    def __init__(self, person: Callable[[], Vector], clock_s: Callable[[], float]) -> None:
        """Store the arguments.

        Args:
            person: returns the place (m) of the person's eyes.
            clock_s: the monotonic clock (s).
        """
        self._person, self._clock_s = person, clock_s
        self._place: Vector | None = None
        """m; None: the mouth of the person"""
        self._playing: PlayingSound | None = None

    def place(self, eyes: Vector) -> Vector:
        """Return the place (m) of the source while the person's eyes are at `eyes`."""
        return self._place or (eyes[0], eyes[1], eyes[2] - MOUTH_BELOW_EYES)

    def playing(self) -> PlayingSound | None:
        """Return the sound that plays; None: silence.

        A sound that has ended stays for a short time, because it is still on its way to the ears.
        """
        playing = self._playing
        heard = playing is not None and self._clock_s() < playing.began_s + playing.seconds + 0.1
        return playing if heard else None

    def change(self, query: SoundQuery, samples: Samples | None) -> None:
        """Carry out a query, as a whole or, if it is refused, not at all.

        Raises:
            Refused: BAD_VALUE.
        """
        place = place_of(query)
        if query.play or query.seconds:
            self._playing = self._play(query, samples)
        if place is not None or query.mouth:
            self._place = place

    def _play(self, query: SoundQuery, samples: Samples | None) -> PlayingSound | None:
        if query.play not in NAMES:
            text = f"There is no sound {quoted(query.play)}. Choose one of {', '.join(NAMES)}."
            raise bad_field("play", text, NAMES)
        text = (
            f"A sound cannot last {query.seconds:g} s; more than 0 and at most {SECONDS_MAX:g} s are allowed."
        )
        check_range("seconds", query.seconds, 0.0, SECONDS_MAX, "s", text)
        if query.play == SILENCE:
            return None
        seconds = query.seconds or SECONDS
        if query.play == SAMPLES:
            if samples is None:
                text = f"Sound of your own is the attachment of the query: int16, mono, {RATE} Hz, at most {SAMPLES_MAX_S:g} s."
                raise bad_field("play", text)
            seconds, samples = query.seconds or len(samples) / RATE, finer(samples)
        else:
            samples = generated(query.play)
        return PlayingSound(query.play, self._clock_s(), seconds, samples)

    def reply(self, refusal: BeatrixError | None) -> SoundReply:
        """Return what plays where, and the refusal if there is one."""
        playing = self._playing
        left_s = 0.0 if playing is None else playing.left_s(self._clock_s())
        x, y, z = self.place(self._person())
        reason, message, detail = told(refusal)
        return SoundReply(
            result=refusal is None,
            reason=reason,
            message=message,
            play=playing.name if playing is not None and left_s > 0 else SILENCE,
            seconds=left_s,
            x=x,
            y=y,
            z=z,
            mouth=self._place is None,
            detail=detail,
        )


def place_of(query: SoundQuery) -> Vector | None:
    """Return the place (m) in a query, None if there is none; raises Refused (BAD_VALUE)."""
    x, y, z = query.x, query.y, query.z
    if (x, y, z) == (None, None, None):
        return None
    if query.mouth:
        raise bad_field(
            "mouth", "The source is either at x, y, z or in the person's mouth: give one of both."
        )
    if x is None or y is None or z is None:
        missing = next(name for name in BOUNDS if getattr(query, name) is None)
        raise bad_field(missing, f"A place needs x, y and z; {missing} is missing.", tuple(BOUNDS))
    place = x, y, z
    check_room(place, "The sound cannot come from")
    away = math.hypot(*place)
    text = (
        f"The sound would come from inside the head, {away:.2f} m from the neck's centre; at least {NEAREST:.2f} m is "
        "allowed."
    )
    check_range("x", away, NEAREST, None, "m", text)
    return place


def samples_of(attachment: bytes) -> Samples | None:
    """Return the samples of an attachment, from -1 to 1; None if there is none. Raises Refused (BAD_VALUE)."""
    if not attachment:
        return None
    if len(attachment) % 2 or len(attachment) > 2 * SAMPLES_MAX_S * RATE:
        text = f"{len(attachment)} bytes are no sound of int16 samples of at most {SAMPLES_MAX_S:g} s at {RATE} Hz."
        raise bad_field("play", text)
    return np.frombuffer(attachment, "<i2").astype(np.float32) / np.float32(FULL_SCALE)


def sound_queries(name: str, source: SoundSource) -> QueryThread:
    """Return what answers queries that play sounds and place their source, on its own thread."""
    return QueryThread(
        "beatrix-sound", {keys.sound(name): lambda incoming: reply(source, incoming.raw, incoming.attachment)}
    )


def reply(source: SoundSource, raw: RawQuery, attachment: bytes) -> SoundReply:
    """Carry out the query if there is one, and return what plays where."""
    return source.reply(
        refused(raw, lambda: source.change(query_forms.read(raw, SoundQuery), samples_of(attachment)))
    )
