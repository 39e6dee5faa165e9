"""Serial line of the Mega: damaged frames, noise, floods and partial frames never move a motor."""

from __future__ import annotations

import random

import pytest
from avr.bench import CYCLES_PER_MS
from avr.mega import Mega
from firmware_host import damaged

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState, Error, FrameType, Move

MOVE = encode(FrameType.MOVE, 7, Move(513, (100, -200, 300), (1400, 1400, 1400)).pack())


@pytest.mark.long("a search, cycle by cycle")
def test_none_of_3000_damaged_moves_is_executed_and_the_next_frame_is_answered() -> None:
    chance, whole = random.Random(1), MOVE.strip(b"\0")
    with Mega() as mega:
        mega.ready()
        served = 0
        for seq in range(3000):
            data = damaged(MOVE, chance)
            while whole in data.split(b"\0"):
                data = damaged(MOVE, chance)
            replies = mega.raw(data + b"\0" + encode(FrameType.PING, seq % 256, b""))
            served += (replies[-1].type, replies[-1].seq, replies[-1].payload) == (0x82, seq % 256, b"\0")
            # A `@` at the beginning of a frame and a later line end form an unknown line of text.
            assert {reply.payload for reply in replies[:-1]} <= {bytes([Error.BAD_LENGTH]), b"\x01NACK\n"}
        mega.tick(50)
        assert served == 3000
        assert mega.steps == (0, 0, 0)
        assert mega.last.motion == 0
        assert BoardState.MOVING not in mega.state


@pytest.mark.long("a minute, cycle by cycle")
def test_a_minute_of_noise_changes_neither_the_state_nor_the_position() -> None:
    chance = random.Random(2)
    minute = 60 * 16_000_000
    with Mega() as mega:
        mega.ready()
        while mega.avr.cycle < minute:
            match chance.randrange(5):
                case 0:
                    data = chance.randbytes(chance.randint(1, 200))
                case 1:
                    data = b"\0" + MOVE[1 : chance.randint(2, len(MOVE) - 2)]
                case 2:
                    data = b"\0@MOVRX 100 100" + b" " * chance.randint(0, 60)
                case 3:
                    data = b"\0@" + b"A" * 500 + b"\r"
                case _:
                    data = bytes(chance.randint(1, 80))
            mega.avr.send(data)
            mega.avr.run_ms(chance.randint(0, 60))
        mega.avr.run_ms(100)
        # After two seconds without a valid frame, only lines are answered, as in 2023.
        assert set(mega.core.transmit().rpartition(b"\0")[2].split()) == {b"ACK", b"NACK"}
        mega.discard_interrupted_frame()
        assert mega.raw(b"\0") == []
        assert mega.ask(FrameType.PING) == Error.OK
        assert mega.steps == (0, 0, 0)
        assert mega.state == BoardState.ENABLED | BoardState.CALIBRATED
        assert mega.avr.resets == 0


def test_a_full_serial_line_loses_no_request_and_no_reply() -> None:
    with Mega() as mega:
        mega.ready()
        mega.move((600, 600, 600))
        burst = b"".join(encode(FrameType.HELLO, seq, b"") for seq in range(1, 30))
        mega.others.clear()
        mega.avr.send(burst)
        mega.tick(100)
        assert [frame.seq for frame in mega.others] == list(range(1, 30))


SLOW_TO_ANSWER = (b"@GETALLPOS\r", b"@FOO\r", b"@\r", b"@MOVAX 1\r")
RECOGNISED_MS = 1.5
"""Longest time from the last byte of a stop frame to its effect, while a slow line of text is handled."""


@pytest.mark.parametrize(
    ("line", "seq"),
    [(SLOW_TO_ANSWER[0], 0), (SLOW_TO_ANSWER[0], 13), *((line, 64) for line in SLOW_TO_ANSWER[1:])],
    ids=lambda value: value.decode().strip() if isinstance(value, bytes) else f"seq {value}",
)
def test_an_emergency_stop_behind_a_flood_of_text_takes_effect_at_once_and_is_acknowledged_once(
    line: bytes, seq: int
) -> None:
    stop = encode(FrameType.EMERGENCY_STOP, seq, b"")
    with Mega() as mega:
        mega.ready()
        mega.raw(b"@CALNOW\r")
        mega.move((1500, 1500, 1500))
        mega.tick(900)
        mega.others.clear()
        arrival = mega.avr.send(line * 200 + stop)
        mega.tick(400)
        off = int(mega.avr.edges("enable")["cycle"][-1])
        assert 0 < off - arrival < RECOGNISED_MS * CYCLES_PER_MS
        acks = [(ack.seq, ack.payload) for ack in mega.others if ack.type == FrameType.EMERGENCY_STOP | 0x80]
        assert acks == [(seq, b"\0")]
        assert mega.state == BoardState.EMERGENCY


def test_a_stop_behind_a_flood_of_targets_brakes_as_soon_as_without_it() -> None:
    stop = encode(FrameType.STOP, 5, b"")
    targets = [Move(600 + i, (1500 - i % 2,) * 3, (4189,) * 3).pack() for i in range(80)]
    flood = b"".join(encode(FrameType.MOVE, 1, target) for target in targets)

    def braking(before: bytes) -> int:
        """Return the time (cycles) from the last byte of STOP to the last step."""
        with Mega() as mega:
            mega.ready()
            mega.move((1500, 1500, 1500))
            mega.tick(350)
            mega.avr.run(len(flood + stop) * mega.avr.byte_cycles - len(before + stop) * mega.avr.byte_cycles)
            arrival = mega.avr.send(before + stop)
            mega.tick(400)  # less than the host's timeout
            mega.run()
            mega.settle()
            assert mega.outcome == BoardOutcome.STOPPED
            return max(int(mega.avr.steps(arm)[0][-1]) for arm in range(3)) - arrival

    assert abs(braking(flood) - braking(b"")) < RECOGNISED_MS * CYCLES_PER_MS


def test_requests_before_a_stop_start_no_motion_after_it() -> None:
    """Moves that wait behind slow lines are handled after the stop frame was carried out."""
    move = encode(FrameType.MOVE, 9, Move(513, (200, 200, 200), (1400, 1400, 1400)).pack())
    with Mega() as mega:
        mega.ready()
        mega.others.clear()
        mega.avr.send(b"@GETALLPOS\r" * 30 + move + b"@CALNOW\r@MOVRX 5\r" + encode(FrameType.STOP, 5, b""))
        mega.tick(400)
        assert mega.steps == (0, 0, 0)
        assert (4 | 0x80, 5) in [(frame.type, frame.seq) for frame in mega.others]
