"""Blocks of sound: their order, the faults that are counted, and pieces without gaps."""

from __future__ import annotations

import wave
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.client.sound import ANEW_NS, BlockOrder, Faults, Sound, joined
from beatrix_zenoh.node.sensors import BLOCK, BLOCK_NS, RATE, to_pcm

BEGIN_NS = 10**12


def block(number: int, *, restarts: int = 0, dropped: int = 0) -> Sound:
    """Return the block of a node that began `restarts` hours later; its samples are its number / 1000."""
    t_ns = BEGIN_NS + number * BLOCK_NS + restarts * 3600 * 10**9
    samples = np.full((BLOCK, 2), number / 1000, np.float32)
    return Sound(samples, RATE, t_ns, t_ns + 5, number, "test", dropped)


def heard(numbers: list[int]) -> tuple[list[int], Faults]:
    order = BlockOrder()
    kept = [number for i, number in enumerate(numbers) if order.accept(block(number), i * BLOCK_NS)]
    return kept, order.faults


@pytest.mark.parametrize(
    ("arrived", "kept", "lost", "duplicated", "late"),
    [
        ([1, 2, 3], [1, 2, 3], 0, 0, 0),
        ([7, 8, 9], [7, 8, 9], 0, 0, 0),
        ([1, 2, 5, 6], [1, 2, 5, 6], 2, 0, 0),
        ([1, 2, 2, 3], [1, 2, 3], 0, 1, 0),
        ([1, 3, 2, 4], [1, 3, 4], 1, 0, 1),
        ([1, 3, 2, 2, 4], [1, 3, 4], 1, 1, 1),
        ([1, 4, 3, 2, 1, 5], [1, 4, 5], 2, 1, 2),
    ],
)
def test_lost_duplicated_and_late_blocks_are_counted(
    arrived: list[int], kept: list[int], lost: int, duplicated: int, late: int
) -> None:
    assert heard(arrived) == (kept, Faults(lost, duplicated, late))


@given(st.permutations(range(1, 9)), st.lists(st.integers(1, 8), max_size=4))
def test_blocks_are_heard_in_order_and_every_other_is_counted_once(
    first: list[int], again: list[int]
) -> None:
    kept, faults = heard([*first, *again])
    assert kept == sorted(set(kept))
    assert len(kept) + faults.late + faults.duplicated == len(first) + len(again)
    assert faults.lost == kept[-1] - kept[0] + 1 - len(kept)


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
    newest = block(1)
    for i, seq in enumerate((2**32 - 1, 0, 1)):
        t_ns = BEGIN_NS + i * BLOCK_NS
        assert order.accept(Sound(newest.samples, RATE, t_ns, t_ns, seq, "test", 0), i * BLOCK_NS)
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
        blocks.append(
            Sound(one.samples, RATE, one.t_mono_ns + error_us * 1000, one.t_wall_ns, number, "test", 0)
        )
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
    assert Sound(np.zeros((5, 2), np.float32), RATE, 0, 0, 1, "test", 0, lost=5).level == (-120.0, -120.0)


def test_a_sound_is_saved_and_shown_as_wav(tmp_path: Path) -> None:
    sound = block(5)
    sound.save(tmp_path / "x.wav")
    with wave.open(str(tmp_path / "x.wav")) as file:
        assert file.getparams()[:4] == (2, 2, RATE, BLOCK)
        assert file.readframes(BLOCK) == to_pcm(sound.samples)
    assert "<audio controls" in sound._repr_html_()
    assert repr(sound) == "<0.02 s of sound (test), left -46 dB, right -46 dB>"
