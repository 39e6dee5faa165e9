"""Blocks of sound: their order, the faults that are counted, and pieces without gaps."""

from __future__ import annotations

import wave
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec.structs import replace

from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.client.sound import ANEW_NS, BlockOrder, Faults, Sound, joined
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import Reason, SoundQuery, SoundReply
from beatrix_zenoh.motion.rotation import Vector
from beatrix_zenoh.node.sensors import BLOCK, BLOCK_NS, RATE, to_pcm
from sim_node.hearing import FINER
from sim_node.sound_queries import MOUTH_BELOW_EYES, SoundSource, reply

BEGIN_NS = 10**12


def block(number: int, *, restarts: int = 0, dropped: int = 0) -> Sound:
    """Return the block of a node that began `restarts` hours later; its samples are its number / 1000."""
    t_ns = BEGIN_NS + number * BLOCK_NS + restarts * 3600 * 10**9
    samples = np.full((BLOCK, 2), number / 1000, np.float32)
    return Sound(
        samples=samples, rate=RATE, t_mono_ns=t_ns, t_wall_ns=t_ns + 5, seq=number, source="test", dropped=dropped
    )  # fmt: skip


@given(st.lists(st.integers(1, 9), min_size=1, max_size=20))
@example([1, 4, 3, 2, 1, 5])
def test_blocks_are_heard_in_order_and_each_other_is_counted_as_lost_duplicated_or_late(
    arrived: list[int],
) -> None:
    order = BlockOrder()
    kept = [number for i, number in enumerate(arrived) if order.accept(block(number), i * BLOCK_NS)]
    newest = [max(arrived[:i], default=0) for i in range(len(arrived))]
    assert kept == [number for number, before in zip(arrived, newest, strict=True) if number > before]
    assert order.faults == Faults(
        lost=kept[-1] - kept[0] + 1 - len(kept),
        duplicated=sum(number == before for number, before in zip(arrived, newest, strict=True)),
        late=sum(number < before for number, before in zip(arrived, newest, strict=True)),
    )


def test_a_restarted_node_counts_anew_without_losses() -> None:
    order = BlockOrder()
    assert order.accept(block(500), 0)
    assert order.accept(block(501), BLOCK_NS)
    for number in (1, 2, 3):
        assert order.accept(block(number, restarts=1), ANEW_NS + (number + 1) * BLOCK_NS)
    assert order.faults == Faults()


@pytest.mark.parametrize("at", [0, 1, 50])
@pytest.mark.parametrize(
    "impossible",
    [
        lambda block: replace(block, t_wall_ns=2**62),
        lambda block: replace(block, seq=2**31 - 2),
        lambda block: replace(block, seq=10**6, t_wall_ns=2**62),
        lambda block: replace(block, t_mono_ns=2**62),
        lambda block: replace(block, seq=3, t_mono_ns=5),
    ],
)
def test_an_impossible_block_silences_a_robot_for_half_a_second_at_most(
    at: int, impossible: Callable[[Sound], Sound]
) -> None:
    order, arrivals = BlockOrder(), [block(number) for number in range(100, 200)]
    arrivals.insert(at, impossible(arrivals[at]))
    kept = [one for i, one in enumerate(arrivals) if order.accept(one, i * BLOCK_NS)]
    assert [one.seq for one in kept[-49:]] == list(range(151, 200))
    assert len(kept) >= len(arrivals) - ANEW_NS // BLOCK_NS - 2
    assert order.faults.lost <= ANEW_NS // BLOCK_NS


def test_after_a_pause_of_the_network_blocks_are_lost_and_those_held_back_are_heard() -> None:
    order = BlockOrder()
    arrivals = [(1, 0.0), (2, 0.02), (103, 2.04), (104, 2.04), (105, 2.04), (106, 2.06)]
    assert all(order.accept(block(number), round(at_s * 1e9)) for number, at_s in arrivals)
    assert order.faults == Faults(lost=100)


def test_sequence_numbers_begin_again_after_the_largest() -> None:
    order = BlockOrder()
    for i, seq in enumerate((2**32 - 1, 0, 1)):
        assert order.accept(replace(block(i), seq=seq), i * BLOCK_NS)
    assert order.faults == Faults()


def test_a_piece_has_zeros_where_a_block_is_missing() -> None:
    piece = joined([block(1), block(2), block(4)], 4 * BLOCK)
    assert piece.lost == BLOCK
    assert [round(float(piece.left[i * BLOCK + 5]) * 1000) for i in range(4)] == [1, 2, 0, 4]
    assert (piece.t_mono_ns, piece.seq, piece.seconds) == (block(1).t_mono_ns, 1, 0.08)


@given(st.integers(1, 5 * BLOCK), st.lists(st.integers(-400, 400), min_size=4, max_size=4))
def test_a_piece_without_losses_has_no_gap_whatever_the_clock_of_the_device(
    wanted: int, errors_us: list[int]
) -> None:
    blocks = [block(1)]
    for number, error_us in enumerate(errors_us, 2):
        one = block(number)
        blocks.append(replace(one, t_mono_ns=one.t_mono_ns + error_us * 1000))
    piece = joined(blocks, wanted)
    assert len(piece.samples) == wanted
    assert piece.lost == 0
    assert np.allclose(piece.left, np.repeat(np.arange(1, 6) / 1000, BLOCK)[:wanted])


def test_what_is_louder_than_16_bits_is_cut_off() -> None:
    pcm = np.frombuffer(to_pcm(np.array([[0.0, 1.0], [-1.0, 3.0], [-3.0, 0.5]])), "<i2")
    assert pcm.tolist() == [0, 32767, -32768, 32767, -32768, 16384]


def test_lost_frames_are_not_silence_in_the_level() -> None:
    blocks = [block(number) for number in range(1, 11)]
    whole, half = (joined(some, 10 * BLOCK) for some in (blocks, [blocks[0], *blocks[4:]]))
    assert half.lost == 3 * BLOCK
    there = np.vstack([one.samples for one in [blocks[0], *blocks[4:]]])
    for level, ear in zip(half.level, there.T, strict=True):
        assert level == pytest.approx(20 * np.log10(np.sqrt(np.mean(np.square(ear)))), abs=1e-4)
    assert whole.lost == 0
    assert replace(block(1), samples=np.zeros((5, 2), np.float32), lost=5).level == (-120.0, -120.0)


def test_a_sound_is_saved_and_shown_as_wav(tmp_path: Path) -> None:
    sound = block(5)
    sound.save(tmp_path / "x.wav")
    with wave.open(str(tmp_path / "x.wav")) as file:
        assert file.getparams()[:4] == (2, 2, RATE, BLOCK)
        assert file.readframes(BLOCK) == to_pcm(sound.samples)
    assert "<audio controls" in sound._repr_html_()
    assert repr(sound) == "<0.02 s of sound (test), left -46 dB, right -46 dB>"


# -- queries about the source of sound: what they change, and what they refuse ---------------------


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
    def place(self) -> Vector:
        return self.source.place(self.eyes)


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
    assert (room.ask("").play, room.source.playing()) == ("silence", None)
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
    assert room.place == pytest.approx(MOUTH)
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
        ("play=noise;seconds=61", "seconds", "at most 60 s"),
        ("x=3;y=0;z=0", "x", "the room allows -1.9 to 2.3 m"),
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
    assert playing.samples[0, ::FINER] * 32768 == pytest.approx(sent, abs=0.01)


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
