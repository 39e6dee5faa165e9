"""Serial line of the Mega: floods delay neither requests nor a stop."""

from __future__ import annotations

import pytest
from avr.bench import CYCLES_PER_MS
from avr.mega import Mega

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState, FrameType, Move


def test_a_full_serial_line_loses_no_request_and_no_reply(mega: Mega) -> None:
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
    line: bytes, seq: int, mega: Mega
) -> None:
    stop = encode(FrameType.EMERGENCY_STOP, seq, b"")
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


def test_requests_before_a_stop_start_no_motion_after_it(mega: Mega) -> None:
    """Moves that wait behind slow lines are handled after the stop frame was carried out."""
    move = encode(FrameType.MOVE, 9, Move(513, (200, 200, 200), (1400, 1400, 1400)).pack())
    mega.others.clear()
    mega.avr.send(b"@GETALLPOS\r" * 30 + move + b"@CALNOW\r@MOVRX 5\r" + encode(FrameType.STOP, 5, b""))
    mega.tick(400)
    assert mega.steps == (0, 0, 0)
    assert (4 | 0x80, 5) in [(frame.type, frame.seq) for frame in mega.others]
