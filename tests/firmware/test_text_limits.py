"""Text motions beyond a limit are shortened on their line and answered as done, with a warning."""

from __future__ import annotations

import math

import pytest
from firmware_host import ARM_SPACING, ARM_TURN, GAP_MIN, Steps, least_gap
from hypothesis import given, settings
from hypothesis import strategies as st
from text_port_programs import DONE, Program

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import FrameType, MoveStraight, WarningCode
from beatrix_zenoh.motion.gear import Gear
from beatrix_zenoh.motion.kinematics import Neck

NECK, GEAR = Neck(), Gear()
TILT_GAP_MIN = math.ceil(GEAR.steps_per_turn / 360 * ROBOT.limits.tilt_gap_min)
TILT_GAP_MAX = math.floor(GEAR.steps_per_turn / 360 * ROBOT.limits.tilt_gap_max)
YAW_SUM_MAX = math.floor(3 * GEAR.steps_per_turn / 360 * ROBOT.limits.text_yaw_max)
"""Largest sum of the arms that the text port allows, microsteps: see firmware/beatrix/src/core/text_limits.cpp."""


def gaps(steps: Steps) -> list[int]:
    """Return the gaps between neighbouring arms, microsteps."""
    x, y, z = steps
    return [ARM_SPACING + y - x, ARM_SPACING + z - y, ARM_TURN - 2 * ARM_SPACING + x - z]


def allowed(steps: Steps) -> bool:
    """Return whether the text port allows this position."""
    return (
        TILT_GAP_MIN <= min(gaps(steps)) <= max(gaps(steps)) <= TILT_GAP_MAX
        and abs(sum(steps)) <= YAW_SUM_MAX
    )


@pytest.mark.parametrize(
    ("target", "warning"),
    [
        ((300, 0, -300), None),  # the limit of the planner of 2023
        ((-300, 0, 300), None),
        ((300, 0, 300), None),
        ((2100, 2100, 2100), None),  # a goal of programs of 2023 that turn the head towards a sound
        ((-2100, -2100, -2100), None),
        ((700, 0, 0), WarningCode.TILT),
        ((0, 900, -900), WarningCode.TILT),
        ((-1000, 0, 1000), WarningCode.TILT),
        ((2120, 2120, 2120), WarningCode.YAW),
        ((2400, 2400, 2400), WarningCode.YAW),
        ((-9000, -9000, -9000), WarningCode.YAW),
        ((32767, 0, 0), WarningCode.TILT),
        ((2600, 2300, 2300), WarningCode.YAW),
    ],
)
def test_a_motion_is_shortened_on_its_line_and_the_limit_is_named(
    framed: Program, target: Steps, warning: WarningCode | None
) -> None:
    x, y, z = target
    assert framed.run(f"@MOVAALL {x} {y} {z}") == DONE
    assert framed.warnings == ([] if warning is None else [warning])
    end = framed.position
    assert end == framed.core.steps()
    assert allowed(end)
    part = max(map(abs, end)) / max(map(abs, target))
    assert all(abs(a - part * b) < 1.01 for a, b in zip(end, target, strict=True))
    beyond = tuple(a + (b > a) - (b < a) for a, b in zip(end, target, strict=True))
    assert end == target or not allowed(beyond) or abs(sum(beyond)) > YAW_SUM_MAX  # type: ignore[arg-type]


TOO_FAR_OUT = MoveStraight(5, (400, -600, 400), 2000).pack()


def test_from_beyond_a_limit_only_motions_back_are_allowed(framed: Program) -> None:
    framed.frame(FrameType.MOVE_STRAIGHT, TOO_FAR_OUT)
    framed.tick(3000)
    assert framed.core.steps() == (400, -600, 400)
    assert not allowed(framed.core.steps())
    assert framed.run("@MOVRY -10") == DONE
    assert framed.core.steps() == (400, -600, 400)
    assert framed.run("@MOVRY 10") == DONE
    assert framed.core.steps() == (400, -590, 400)
    assert framed.run("@MOVHOME") == DONE
    assert framed.core.steps() == (0, 0, 0)
    assert framed.warnings == [WarningCode.TILT]


ANYWHERE = st.integers(-3000, 3000)
MOVES = st.tuples(st.sampled_from(["@MOVAALL", "@MOVRALL"]), st.tuples(ANYWHERE, ANYWHERE, ANYWHERE))


@settings(max_examples=6)
@given(st.lists(MOVES, min_size=1, max_size=5))
def test_random_programs_never_move_the_arms_beyond_the_limits(script: list[tuple[str, Steps]]) -> None:
    program = Program(framed=True).ready()
    for word, (x, y, z) in script:
        program.send(f"{word} {x} {y} {z}\r".encode("ascii"))
        for _ in range(3000):
            if len(program.lines) % 2 == 0:
                break
            program.tick(20)
            assert least_gap(program.core.steps()) >= GAP_MIN
            assert abs(sum(program.core.steps())) <= YAW_SUM_MAX
        assert program.new() == DONE
        assert allowed(program.core.steps())


def tilt(steps: Steps) -> float:
    """Return the tilt of the head (deg)."""
    return math.degrees(math.acos(min(1.0, NECK.head(GEAR.to_rad(steps)).up)))


def border() -> list[Steps]:
    """Return the positions on the border of the text port's limits at which the short arm is at 0."""
    low, high = TILT_GAP_MIN - ARM_SPACING, TILT_GAP_MAX - ARM_SPACING
    poses: list[Steps] = []
    for first in range(low, high + 1):
        seconds = range(max(low, -high - first), min(high, -low - first) + 1)
        ends = seconds if first in (low, high) else (seconds[0], seconds[-1])
        poses.extend((0, first, first + second) for second in ends)
    return poses


def test_the_tilt_is_within_its_limit_on_the_whole_border() -> None:
    poses = border()
    assert len(poses) > 4000
    assert all(allowed(pose) for pose in poses)
    tilts = [tilt(pose) for pose in poses]
    assert max(tilts) <= ROBOT.limits.tilt_max
    assert max(tilts) > ROBOT.limits.tilt_max - 0.1
