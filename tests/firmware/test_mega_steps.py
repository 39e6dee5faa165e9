"""The Mega, edge by edge: every reported step is made, timing is within the limits of the drivers, and floods on the
serial line delay neither requests nor a stop."""

from __future__ import annotations

import random
from collections.abc import Iterator

import numpy as np
import pytest
from avr.bench import BUDGETS, CYCLES_PER_MS, VECTORS
from avr.mega import HEX, Mega
from firmware_host import KEEP_ALIVE_MS, SPEED_MAX, Steps

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState, FrameType, Move


@pytest.fixture(
    params=["shipped", pytest.param("sketch", marks=pytest.mark.long("compiled as in the Arduino IDE"))]
)
def ready(request: pytest.FixtureRequest) -> Iterator[Mega]:
    """A Mega with either build of the firmware, enabled and calibrated.

    At its end, the fixture checks the pins and the interrupt budgets.
    """
    with Mega(HEX if request.param == "shipped" else request.getfixturevalue("sketch")) as mega:
        mega.ready()
        yield mega
        longest = {name: mega.avr.work(vector).longest for vector, name in VECTORS.items()}
        assert [name for name, cycles in longest.items() if cycles > BUDGETS[name]] == [], longest


def test_reported_positions_equal_the_steps_on_the_pins(mega: Mega) -> None:
    chance = random.Random(5)
    origin = (0, 0, 0)
    for _ in range(25):
        around = chance.randint(-300, 300)
        target = tuple(around + chance.randint(-150, 150) for _ in range(3))
        mega.move(target, chance.choice([SPEED_MAX, 1400]), straight=chance.random() < 0.5)  # type: ignore[arg-type]
        mega.tick(chance.randint(0, 400))
        match chance.randrange(8):
            case 0:
                mega.ask(FrameType.STOP)
            case 1:
                mega.ask(FrameType.EMERGENCY_STOP)
            case 2:
                mega.enable(0)
        if BoardState.ENABLED not in mega.state:
            mega.settle()
            counted = tuple(p + o for p, o in zip(mega.last.position, origin, strict=True))
            assert counted == mega.steps
            mega.ask(FrameType.RESET)
            mega.ready()
            origin = mega.steps
    mega.run()
    mega.settle()
    assert tuple(p + o for p, o in zip(mega.last.position, origin, strict=True)) == mega.steps


def test_in_motion_the_count_is_at_most_two_milliseconds_ahead_of_the_pins(ready: Mega) -> None:
    ready.move((600, 600, 600), 4000)
    for _ in range(50):
        ready.tick(13)
        ahead = [t - p for t, p in zip(ready.last.position, ready.steps, strict=True)]
        # Telemetry is up to 10 ms old and takes 2 ms on the wire, so the pins may be further than it reports.
        assert all(-13 <= steps <= 2 for steps in ahead)


@pytest.mark.parametrize("speeds", [(800, 800, 800), (800, 560, 240), (SPEED_MAX, SPEED_MAX, SPEED_MAX)])
def test_steps_are_evenly_spaced_within_two_cycles(ready: Mega, speeds: Steps) -> None:
    ready.move((2000, 2000, 2000), speeds)
    for _ in range(4):
        ready.tick(KEEP_ALIVE_MS)
        ready.ask(FrameType.PING)
    for arm, speed in enumerate(speeds):
        periods = np.diff(ready.avr.steps(arm)[0])[-speed // 4 :]
        assert abs(periods.mean() - 64_000_000 / speed) < 1
        assert np.abs(periods - periods.mean()).max() <= 2


def test_stop_brings_the_arms_to_rest_within_520_ms_on_a_counted_step(ready: Mega) -> None:
    ready.move((900, 900, 900), SPEED_MAX)
    ready.tick(400)
    asked = ready.avr.cycle
    ready.ask(FrameType.STOP)
    ready.run()
    ready.settle()
    assert ready.outcome == BoardOutcome.STOPPED
    assert ready.last.position == ready.steps
    assert ready.avr.enabled
    rises = ready.avr.edges("step", 0)
    rises = rises[rises["level"] == 1]["cycle"].astype(np.int64)
    assert rises[-1] - asked < 16_000 * 520


def test_an_emergency_stop_switches_the_drivers_off_at_once(ready: Mega) -> None:
    ready.move((900, 900, 900), SPEED_MAX)
    ready.tick(400)
    ready.ask(FrameType.EMERGENCY_STOP)
    assert not ready.avr.enabled
    at = ready.steps
    ready.settle()
    assert (ready.steps, ready.outcome) == (at, BoardOutcome.EMERGENCY)
    assert ready.last.position == at


# -- the serial line -------------------------------------------------------------------------------


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
