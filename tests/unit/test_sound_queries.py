"""Queries about the source of sound: what they change, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import Reason, SoundQuery, SoundReply
from beatrix_zenoh.node.sensors import RATE
from sim_node.shapes import Point
from sim_node.sound_queries import MOUTH_BELOW_EYES, SoundSource, reply

EYES = (1.15, 0.0, 0.16)
MOUTH = (1.15, 0.0, 0.16 - MOUTH_BELOW_EYES)
SECOND = bytes(2 * RATE)


class Room:
    """A source of sound with a clock that the test sets."""

    def __init__(self) -> None:
        self.now_s, self.eyes = 100.0, EYES
        self.source = SoundSource(lambda: self.eyes, lambda: self.now_s)

    def ask(self, text: str, attachment: bytes = b"") -> SoundReply:
        """Send parameters or, if the text begins with a brace, JSON."""
        json = text.startswith("{")
        raw = RawQuery(text.encode() if json else b"", "", "" if json else text)
        return reply(self.source, raw, attachment)

    @property
    def place(self) -> Point:
        return self.source.place(self.eyes)


def test_at_the_start_the_mouth_of_the_person_is_silent() -> None:
    room = Room()
    answer = room.ask("")
    assert (answer.result, answer.play, answer.seconds, answer.mouth) == (True, "silence", 0.0, True)
    assert room.source.playing() is None
    assert room.place == pytest.approx(MOUTH)


@pytest.mark.parametrize(
    ("text", "attachment", "name", "seconds"),
    [
        ("play=noise", b"", "noise", 3.0),
        ("play=clap;seconds=0.5", b"", "clap", 0.5),
        ('{"play":"voice","seconds":60}', b"", "voice", 60.0),
        ("play=samples", SECOND, "samples", 1.0),
        ("play=samples;seconds=5", SECOND, "samples", 5.0),
    ],
)
def test_a_sound_plays_as_long_as_asked(text: str, attachment: bytes, name: str, seconds: float) -> None:
    room = Room()
    assert room.ask(text, attachment).play == name
    room.now_s += seconds - 0.01
    playing = room.source.playing()
    assert playing is not None
    assert (playing.name, playing.seconds) == (name, seconds)
    room.now_s += 0.05
    assert room.ask("").play == "silence"
    assert room.source.playing() is not None, "the last of the sound is still on its way"
    room.now_s += 0.2
    assert room.source.playing() is None


def test_a_placed_source_stays_and_the_mouth_moves_with_the_person() -> None:
    room = Room()
    room.ask("x=1;y=-0.5;z=0.1")
    room.eyes = (0.5, 1.0, 0.2)
    assert room.place == pytest.approx((1.0, -0.5, 0.1))
    answer = room.ask('{"mouth":true}')
    assert answer.mouth
    assert (answer.x, answer.y, answer.z) == pytest.approx((0.5, 1.0, 0.2 - MOUTH_BELOW_EYES))


def test_placing_leaves_the_sound_and_playing_leaves_the_place() -> None:
    room = Room()
    room.ask("x=1;y=0.5;z=0.1")
    room.ask("play=voice;seconds=10")
    room.now_s += 1
    answer = room.ask("x=0.8;y=0.5;z=0.1")
    assert (answer.play, round(answer.seconds, 3)) == ("voice", 9.0)
    assert room.ask("play=noise").x == pytest.approx(0.8)


@pytest.mark.parametrize(
    ("text", "field", "teaches"),
    [
        ("play=bark", "play", "Choose one of clap, voice, noise, samples, silence"),
        ('{"play":"bark","x":1.0,"y":0.5,"z":0.2}', "play", "Choose one of"),
        ("play=noise;seconds=-1", "seconds", "at most 60 s"),
        ("play=noise;seconds=61", "seconds", "at most 60 s"),
        ('{"seconds":3}', "play", "Choose one of"),
        ("x=3;y=0;z=0", "x", "the room allows -1.9 to 2.3 m"),
        ("x=0;y=0;z=1.2", "z", "the room allows -0.6 to 1.1 m"),
        ("x=0.1;y=0.1;z=0.1", "x", "inside the head"),
        ('{"x":1.0,"y":0.5}', "z", "z is missing"),
        ('{"x":1.0,"y":0.5,"z":0.1,"mouth":true}', "mouth", "give one of both"),
        ("play=samples", "play", "attachment"),
        ("play=noise;seconds=loud", "seconds", "float"),
    ],
)
def test_a_refusal_changes_nothing_and_says_what_is_allowed(text: str, field: str, teaches: str) -> None:
    room = Room()
    room.ask("x=1;y=0.5;z=0.1")
    room.ask("play=voice;seconds=10")
    before = room.ask("")
    answer = room.ask(text)
    assert (answer.result, answer.reason) == (False, Reason.BAD_VALUE)
    assert teaches in answer.message
    assert answer.detail is None or answer.detail.field == field
    after = room.ask("")
    assert after == before


@pytest.mark.parametrize("attachment", [bytes(3), bytes(2 * 10 * RATE + 2)])
def test_an_attachment_that_is_no_sound_or_too_long_is_refused(attachment: bytes) -> None:
    assert "at most 10 s at 48000 Hz" in Room().ask("play=samples", attachment).message


def test_samples_are_heard_as_they_were_sent() -> None:
    room = Room()
    sent = np.arange(-1000, 1000, dtype="<i2")
    room.ask("play=samples", sent.tobytes())
    playing = room.source.playing()
    assert playing is not None
    assert (playing.samples * 32768 == sent).all()


@given(st.binary(max_size=60), st.sampled_from(["", codec.MSGPACK]), st.binary(max_size=9))
def test_any_query_is_answered(payload: bytes, encoding: str, attachment: bytes) -> None:
    answer = reply(Room().source, RawQuery(payload, encoding, ""), attachment)
    assert answer.result or answer.message


@given(
    st.builds(
        SoundQuery,
        play=st.sampled_from(["", "noise", "silence", "bark"]),
        seconds=st.floats(width=32, allow_nan=False, allow_infinity=False),
        x=st.none() | st.floats(-3, 3, width=32),
        y=st.none() | st.floats(-3, 3, width=32),
        z=st.none() | st.floats(-3, 3, width=32),
        mouth=st.booleans(),
    )
)
def test_no_query_puts_the_source_outside_the_room(query: SoundQuery) -> None:
    room = Room()
    reply(room.source, RawQuery(codec.encode(query), codec.MSGPACK, ""), b"")
    x, y, z = room.place
    assert -1.9 <= x <= 2.3
    assert -2.0 <= y <= 2.0
    assert -0.6 <= z <= 1.1
    playing = room.source.playing()
    assert playing is None or 0 < playing.seconds <= 60
