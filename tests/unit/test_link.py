"""Framing: the golden bytes of the contract, chunks of any size, invalid input."""

from __future__ import annotations

import itertools
import json
import random
import statistics
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.board.link import Decoder, SerialFrame, crc16, encode
from beatrix_zenoh.board.timing import BOOT_S, FOREIGN_S, HELLO_S, LOADER_S, TRIES, BoardClock, Handshake
from beatrix_zenoh.contract._generated.serial import MAX_ENCODED, MAX_PAYLOAD, FrameType

VECTORS = json.loads(
    (Path(__file__).resolve().parents[2] / "schemas/vectors/serial.json").read_text(encoding="utf-8")
)
BYTE = st.integers(0, 255)
FRAMES = st.builds(SerialFrame, BYTE, BYTE, st.binary(max_size=MAX_PAYLOAD))


def test_the_crc_has_the_check_value_of_the_catalogue() -> None:
    assert crc16(b"123456789") == 0x6F91  # check value of CRC-16/MCRF4XX


@pytest.mark.parametrize("vector", VECTORS, ids=lambda v: f"{v['frame']}-{v['seq']}")
def test_golden_frames_are_decoded_and_encoded(vector: dict[str, str]) -> None:
    wire = bytes.fromhex(vector["wire"])
    (frame,) = Decoder().feed(wire)
    assert (frame.type, frame.seq) == (FrameType[vector["frame"]], int(vector["seq"]))
    assert encode(*frame) == wire


@given(FRAMES)
def test_an_encoded_frame_contains_no_delimiter_and_does_not_begin_like_text(frame: SerialFrame) -> None:
    block = encode(*frame)[1:-1]
    assert 0 not in block
    assert len(block) <= MAX_ENCODED
    assert block[0] != ord("@")


@given(st.lists(FRAMES, max_size=5), st.lists(st.integers(0, 400), max_size=12))
def test_chunks_of_any_size_give_the_same_frames(frames: list[SerialFrame], cuts: list[int]) -> None:
    wire, decoder, got, at = b"".join(encode(*frame) for frame in frames), Decoder(), [], 0
    for cut in [*sorted(cuts), len(wire)]:
        got += decoder.feed(wire[at:cut])
        at = max(at, cut)
    assert got == frames
    assert decoder.rejected == 0


@given(st.lists(st.binary(max_size=300), max_size=8), FRAMES)
def test_garbage_never_raises_and_the_next_frame_is_decoded(garbage: list[bytes], frame: SerialFrame) -> None:
    decoder = Decoder()
    for chunk in garbage:
        decoder.feed(chunk)
    assert decoder.feed(encode(*frame))[-1] == frame


@given(FRAMES, st.data())
def test_a_truncated_frame_is_rejected(frame: SerialFrame, data: st.DataObject) -> None:
    wire = encode(*frame)
    half = wire[: data.draw(st.integers(2, len(wire) - 2))]
    decoder = Decoder()
    assert decoder.feed(half) == []
    *before, last = decoder.feed(wire)
    assert last == frame
    # One of 256 truncated frames is a frame with a payload one byte shorter and a correct CRC (a property of CRCs
    # without a final xor); the check of the payload's length rejects it.
    assert [cut.payload for cut in before] in ([], [frame.payload[:-1]])
    assert len(before) + decoder.rejected == 1


def test_endless_garbage_does_not_fill_memory() -> None:
    decoder = Decoder()
    for _ in range(100):
        decoder.feed(b"U" * 10_000)
    assert len(decoder._block) <= MAX_ENCODED + 1


def test_a_payload_that_is_too_long_raises_value_error() -> None:
    with pytest.raises(ValueError, match="57 bytes: a frame contains at most 56"):
        encode(1, 1, bytes(MAX_PAYLOAD + 1))


# -- clock conversion: the error of the estimate with delays, drift, resets and pauses -------------


MS = 1_000_000
PERIOD_MS = 10


def estimate_errors(
    clock: BoardClock, seconds: float, *, drift_ppm: float = 0.0, begin_ms: int = 0, at_ns: int = 10**12
) -> list[float]:
    """Return the error (ms) of each estimate; telemetry comes every 10 ms, up to 5 ms late, one in fifty 50 ms late."""
    chance, errors = random.Random(1), []
    for n in range(int(seconds * 1000 / PERIOD_MS)):
        true_ns = at_ns + round(n * PERIOD_MS * MS * (1 + drift_ppm / 1e6))
        delay_ns = 50 * MS if chance.random() < 0.02 else round(chance.random() * 5 * MS)
        estimate_ns = clock.feed((begin_ms + n * PERIOD_MS) % 65536, true_ns + delay_ns)
        assert estimate_ns <= true_ns + delay_ns, "it is never later than the arrival"
        errors.append((estimate_ns - true_ns) / MS)
    return errors


@pytest.mark.parametrize("drift_ppm", [0, 100, -100, 1000, -1000])
def test_errors_are_below_2_ms_with_a_deviation_below_1_ms(drift_ppm: float) -> None:
    """Half a minute before and after the tick wraps around."""
    errors = estimate_errors(BoardClock(), 60, drift_ppm=drift_ppm, begin_ms=65536 - 30_000)[500:]
    assert statistics.pstdev(errors) < 1
    assert max(map(abs, errors)) < 2


def test_the_estimate_recovers_within_200_ms_of_a_restart() -> None:
    clock = BoardClock()
    estimate_errors(clock, 20)
    clock.restart()
    errors = estimate_errors(clock, 5, at_ns=2 * 10**12)
    assert max(map(abs, errors[20:])) < 1


@pytest.mark.parametrize("pause_ms", [20, 100, 700, 40_000])
def test_the_estimate_recovers_within_1_2_s_of_a_pause_of_virtual_time(pause_ms: int) -> None:
    """The tick continues from its last value, at a later time of the host's clock."""
    clock = BoardClock()
    estimate_errors(clock, 20)
    errors = estimate_errors(clock, 5, begin_ms=20_000, at_ns=10**12 + (20_000 + pause_ms) * MS)
    assert max(map(abs, errors[120:])) < 1


# -- handshake: no bytes to a board that may have been reset; HELLO at once to a board that sends --


STEP_S = 0.01
LOADER_LISTENS_S, LOADER_WAITS_S = 0.9, 5.0
"""Time that the boot loader waits for a first byte, and after the last one. test_boot_loader.py runs a real one."""


def hello_times(handshake: Handshake, until_s: float, *, foreign: bool = False) -> list[float]:
    """Return the times (s) of HELLO from 0 to `until_s`."""
    times = []
    for now in itertools.takewhile(lambda t: t < until_s, (n * STEP_S for n in itertools.count())):
        if handshake.due(now):
            handshake.hello_sent(now, foreign=foreign)
            times.append(now)
    return times


def test_nothing_is_sent_while_the_board_starts() -> None:
    first, *rest = hello_times(Handshake(0.0, BOOT_S), 20.0)
    assert first == pytest.approx(BOOT_S, abs=STEP_S)
    assert first > LOADER_LISTENS_S
    assert rest[0] - first == pytest.approx(HELLO_S, abs=2 * STEP_S)


def test_pauses_between_hellos_are_long_enough_for_a_boot_loader() -> None:
    times = hello_times(Handshake(0.0, 0.0), 30.0)
    pauses = [later - earlier for earlier, later in itertools.pairwise(times)]
    assert [pause > LOADER_WAITS_S for pause in pauses[: 2 * TRIES]] == 2 * ([False] * (TRIES - 1) + [True])


def test_after_a_loss_there_is_a_pause_unless_a_frame_arrives() -> None:
    handshake = Handshake(0.0, 0.0)
    handshake.hello_sent(0.0, foreign=False)
    handshake.lost(1.0)
    assert not handshake.due(1.0 + LOADER_WAITS_S)
    assert handshake.due(1.0 + LOADER_S)
    handshake.frame_received()
    assert handshake.due(1.0)


def test_hellos_to_foreign_firmware_are_too_rare_for_a_heartbeat() -> None:
    times = hello_times(Handshake(0.0, 0.0), 10.0, foreign=True)
    assert min(later - earlier for earlier, later in itertools.pairwise(times)) > FOREIGN_S - STEP_S
