"""Pins of the Mega, edge by edge: every reported step is made, and its timing is within the limits of the drivers."""

from __future__ import annotations

import random
from collections.abc import Iterator

import numpy as np
import pytest
from avr.bench import BUDGETS, VECTORS
from avr.mega import HEX, Mega
from firmware_host import KEEP_ALIVE_MS, SPEED_MAX, Steps

from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState, FrameType


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
