"""The Mega's serial wire: damaged frames, noise, floods, half frames, and none of it moves a motor."""

from __future__ import annotations

import random
from itertools import pairwise

from avr.bench import CYCLES_PER_MS, TICK
from avr.mega import Mega
from rig import damaged

from beatrix_zenoh._generated.serial import Error, FrameType, Move, State
from beatrix_zenoh.board.link import encode

MOVE = encode(FrameType.MOVE, 7, Move(513, (100, -200, 300), (1400, 1400, 1400)).pack())


def test_of_3000_damaged_moves_none_is_acted_on_and_the_next_frame_is_served() -> None:
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
            # A `@` where a frame begins, and a line end behind it, make text of no known word.
            assert {reply.payload for reply in replies[:-1]} <= {bytes([Error.BAD_LENGTH]), b"\x01NACK\n"}
        mega.tick(50)
        assert served == 3000
        assert mega.steps == (0, 0, 0)
        assert mega.last.motion == 0
        assert State.MOVING not in mega.state


def test_a_minute_of_noise_leaves_board_and_motors_as_they_were() -> None:
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
        # Two seconds without a valid frame: lines are answered as in 2023, nothing else is.
        assert set(mega.core.transmit().rpartition(b"\0")[2].split()) == {b"ACK", b"NACK"}
        mega.hear_again()
        assert mega.raw(b"\0") == []
        assert mega.ask(FrameType.PING) == Error.OK
        assert mega.steps == (0, 0, 0)
        assert mega.state == State.ENABLED | State.CALIBRATED
        assert mega.avr.resets == 0


def test_a_full_wire_loses_no_request_and_no_reply() -> None:
    with Mega() as mega:
        mega.ready()
        mega.move((600, 600, 600))
        burst = b"".join(encode(FrameType.HELLO, seq, b"") for seq in range(1, 30))
        mega.others.clear()
        mega.avr.send(burst)
        mega.tick(100)
        assert [frame.seq for frame in mega.others] == list(range(1, 30))


def test_replies_come_while_nobody_reads_telemetry_in_order() -> None:
    with Mega() as mega:
        mega.ready()
        mega.tick(1000)
        ticks = [t.tick for t in mega.telemetry[-90:]]
        assert {b - a for a, b in pairwise(ticks)} == {10}


def test_a_reply_whose_queueing_is_interrupted_by_a_tick_is_sent_once() -> None:
    """Long enough for the wire to send all that is queued before the tick lets go."""
    pings = encode(FrameType.PING, 1, b"") * 2
    with Mega() as mega:
        mega.ready()
        mega.move((-2200, -2200, -2200))
        mega.run()
        mega.move((2200, 2200, 2200))
        mega.tick(300)
        for early in range(700, 1100):
            due = mega.avr.work(TICK).last + 2 * CYCLES_PER_MS
            mega.avr.run_until(due - early - len(pings) * mega.avr.byte_cycles)
            assert len(mega.raw(pings)) == 2
        mega.run()
        mega.settle()
