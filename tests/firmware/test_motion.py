"""Motions of the firmware, tick by tick in virtual time."""

from __future__ import annotations

import itertools
import math

import pytest
from firmware_host import ACCELERATION, SPEED_MAX, Rig, Steps
from hypothesis import example, given, settings
from hypothesis import strategies as st

from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState, Error, FrameType

Point = tuple[float, float, float]
ROUNDING = 4 / (1 << 26)
"""Largest error of a second difference of set points, which are read in Q26 (microsteps)."""
TOGETHER = st.integers(-1500, 1500)
APART = st.integers(-250, 250)
TARGETS = st.builds(lambda c, x, y, z: (c + x, c + y, c + z), TOGETHER, APART, APART, APART)
SPEEDS = st.tuples(*[st.integers(1000, SPEED_MAX)] * 3)


DEAD_STOP_SPEED = 0.15
"""Highest speed from which an arm may stop within a tick, microsteps per tick."""


class Watched:
    """A board whose set points are recorded every tick."""

    def __init__(self) -> None:
        self.firmware = Firmware()
        self.rig = Rig(self.firmware).ready()
        self.path: list[Point] = [(0.0, 0.0, 0.0)]
        self.steps: list[Steps] = [(0, 0, 0)]

    def tick(self, ms: int = 1) -> None:
        """Run ticks of 1 ms, with heartbeats."""
        for _ in range(ms):
            self.rig.tick()
            self.path.append(self.firmware.set_points())
            self.steps.append(self.rig.steps)
            if len(self.path) % 400 == 0:
                self.rig.ask(FrameType.PING)

    def run(self) -> None:
        """Run until the arms rest."""
        while BoardState.MOVING in self.rig.state:
            self.tick()
            assert len(self.path) < 100_000

    def moves(self) -> list[Point]:
        """Return the distance of each tick, in microsteps."""
        return [(b[0] - a[0], b[1] - a[1], b[2] - a[2]) for a, b in itertools.pairwise(self.path)]


@settings(max_examples=10)
@given(TARGETS, SPEEDS, st.booleans())
def test_every_motion_ends_exactly_at_its_target(target: Steps, speed: Steps, straight: bool) -> None:
    rig = Rig().ready()
    if rig.move(target, speed, straight=straight) == Error.OK:
        rig.run()
        if rig.outcome == BoardOutcome.DONE:
            assert rig.steps == rig.last.position == target
            assert rig.last.velocity == (0, 0, 0)
        else:
            assert rig.outcome == BoardOutcome.GAP  # the arms have different speeds, and two came too close


def test_top_speed_and_ramp_times_are_exact() -> None:
    watched = Watched()
    watched.rig.move((2000, 2000, 2000), 4000)
    watched.run()
    speeds = [move[0] for move in watched.moves()]
    assert max(speeds) == pytest.approx(1.0, abs=1e-6)
    ramp = 1 / ACCELERATION
    assert len(speeds) == pytest.approx(2000 + ramp, abs=3)


@settings(max_examples=6)
@given(st.lists(st.tuples(TARGETS, SPEEDS, st.booleans(), st.integers(1, 900)), min_size=1, max_size=6))
@example(  # the last target is 0.02 microsteps ahead
    [
        ((138, 367, 367), (1604, 1000, 1000), False, 481),
        ((49, -304, -146), (2535, 1000, 1000), True, 94),
        ((127, 376, 376), (1000, 1000, 1000), False, 1),
    ]
)
def test_a_new_target_in_motion_keeps_the_acceleration_limit_and_is_reached(
    script: list[tuple[Steps, Steps, bool, int]],
) -> None:
    watched = Watched()
    allowed = []
    for target, speed, straight, ms in script:
        # If the arms rest, the last tick of the old motion and the first of the new one may each change the speed by
        # up to the acceleration.
        allowed.append((len(watched.path) - 1, BoardState.MOVING not in watched.rig.state))
        same = (speed[0],) * 3  # arms at the same speed keep their gaps
        watched.rig.move(target, same, straight=straight)
        watched.tick(ms)
    watched.run()
    if watched.rig.outcome != BoardOutcome.DONE:
        return  # a limit ended the motion, which places the arms at their last steps
    assert watched.rig.steps == watched.rig.last.position
    starts, retargets = {tick for tick, rested in allowed if rested}, {tick for tick, _ in allowed}
    moves = [(0.0, 0.0, 0.0), *watched.moves()]
    for tick, (before, after) in enumerate(itertools.pairwise(moves)):
        bound = ACCELERATION * (2 if tick in starts else 1) + 1e-8
        for a, b in zip(before, after, strict=True):
            # A slow arm stops at once if braking would overshoot the new target; then it starts again from rest.
            stopped = (
                tick in retargets and abs(a) <= DEAD_STOP_SPEED and (a * b <= 0 or abs(b) <= bound + ROUNDING)
            )
            dead = abs(a) if stopped else 0.0
            assert abs(b - a) <= bound + dead + ROUNDING, tick


@settings(max_examples=6)
@given(TARGETS, st.integers(400, SPEED_MAX), TARGETS)
def test_a_straight_move_from_rest_is_straight_and_all_arms_arrive_together(
    first: Steps, speed: int, target: Steps
) -> None:
    watched = Watched()
    if watched.rig.move(first, straight=True) != Error.OK:
        return
    watched.rig.run()
    start, begin = watched.rig.steps, len(watched.path)
    watched.path[-1] = (float(start[0]), float(start[1]), float(start[2]))
    way = [b - a for a, b in zip(start, target, strict=True)]
    length = math.hypot(*way)
    if length == 0 or watched.rig.move(target, speed, straight=True) != Error.OK:
        return
    watched.run()
    assert watched.rig.steps == target
    for point in watched.steps[begin:]:
        moved = [p - a for p, a in zip(point, start, strict=True)]
        along = sum(g * w for g, w in zip(moved, way, strict=True)) / length
        off = math.sqrt(max(0.0, sum(g * g for g in moved) - along * along))
        assert off < 1.5
    moves = watched.moves()[begin - 1 :]
    ends = [max(tick for tick, move in enumerate(moves) if move[arm]) for arm in range(3) if way[arm]]
    assert all(moves[0][arm] for arm in range(3) if way[arm])
    assert max(ends) - min(ends) <= 2


@settings(max_examples=10)
@given(TARGETS, SPEEDS, st.booleans(), st.integers(1, 1500))
def test_stop_slows_every_arm_in_the_next_tick(target: Steps, speed: Steps, straight: bool, ms: int) -> None:
    watched = Watched()
    watched.rig.move(target, speed, straight=straight)
    watched.tick(ms)
    if BoardState.MOVING not in watched.rig.state or BoardState.STOPPING in watched.rig.state:
        return
    before = watched.moves()[-1]
    watched.rig.ask(FrameType.STOP)
    assert BoardState.STOPPING in watched.rig.state
    watched.tick()
    if BoardState.MOVING in watched.rig.state:
        after = watched.moves()[-1]
        assert all(abs(b) < abs(a) or a == b == 0 for a, b in zip(before, after, strict=True))
    watched.run()
    assert watched.rig.outcome == BoardOutcome.STOPPED
    assert watched.rig.last.position == watched.rig.steps == watched.steps[-1]
    assert watched.path[-1] == watched.steps[-1]
    longest = max(abs(v) for v in before) / ACCELERATION
    assert len(watched.path) < longest * 16 + ms + 10


def test_a_stop_stays_on_the_straight_line() -> None:
    watched = Watched()
    watched.rig.move((900, 300, -100), straight=True)
    watched.tick(400)
    watched.rig.ask(FrameType.STOP)
    watched.run()
    x, y, z = watched.rig.steps
    assert y == pytest.approx(x / 3, abs=1.1)
    assert z == pytest.approx(-x / 9, abs=1.1)


@pytest.mark.parametrize("straight", [False, True], ids=["each", "straight"])
@pytest.mark.parametrize("speed", [SPEED_MAX, 200])
@pytest.mark.parametrize(("first", "then"), [(300, -300), (-8, 5)])
def test_a_slow_arm_reverses_without_a_further_step_in_the_old_direction(
    first: int, then: int, speed: int, straight: bool
) -> None:
    """If an arm has made at most four microsteps, a new target behind it causes no step forward and back again."""
    way = 1 if first > 0 else -1
    for wait_ms in range(1, 60, 2):
        rig = Rig().ready()
        rig.move((first,) * 3, speed, straight=straight)
        rig.tick(wait_ms)
        made = rig.steps[0]
        if abs(made) > 4 or BoardState.MOVING not in rig.state:
            break
        rig.move((then,) * 3, speed, straight=straight)
        for _ in range(100):
            rig.tick(1)
            assert (rig.steps[0] - made) * way <= 0, f"after {wait_ms} ms"
        rig.run()
        assert rig.steps == (then,) * 3
