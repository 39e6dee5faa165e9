"""Values of the robot that are compiled into the firmware, in its units of angle, speed and acceleration.

Robots with equal values can run the same firmware.
"""

from __future__ import annotations

import math

TICK_HZ = 1000
QUARTERS = 4  # speeds on the wire are quarter microsteps per second
FRACTION_BITS = 26

Robot = dict[str, dict[str, object]]


def number(robot: Robot, table: str, name: str) -> float:
    """Return the value of a row of robot.toml."""
    return float(robot[table][name]["value"])  # type: ignore[index]


def microsteps_per_degree(robot: Robot) -> float:
    """Return the microsteps per degree of an arm."""
    steps = number(robot, "drive", "full_steps") * number(robot, "drive", "microsteps")
    return steps * number(robot, "drive", "gear_ring") / number(robot, "drive", "gear_pinion") / 360


def compiled(robot: Robot) -> dict[str, int]:
    """Return the constants of the firmware by name; limits of the text port are rounded to the safe side."""
    per_degree = microsteps_per_degree(robot)

    def steps(name: str) -> float:
        return number(robot, "limits", name) * per_degree

    return {
        "ARM_SPACING": round(number(robot, "geometry", "arm_spacing") * per_degree),
        "ARM_TURN": round(360 * per_degree),
        "GAP_MIN": round(steps("guard_gap_min")),
        "YAW_SUM_MAX": round(3 * steps("guard_yaw_max")),
        "TILT_GAP_MIN": math.ceil(steps("tilt_gap_min")),
        "TILT_GAP_MAX": math.floor(steps("tilt_gap_max")),
        "TEXT_YAW_SUM_MAX": math.floor(3 * steps("text_yaw_max")),
        "TEXT_SPEED": round(number(robot, "limits", "text_speed") * QUARTERS),
        "SPEED_MAX": round(steps("speed_max") * QUARTERS) + QUARTERS,
        "ACCELERATION": round(steps("acceleration") * 2**FRACTION_BITS / TICK_HZ**2),
    }


MEANING = {
    "ARM_SPACING": "microsteps between neighbouring arms at home",
    "ARM_TURN": "microsteps of a whole turn of an arm",
    "GAP_MIN": "smallest gap between neighbouring arms, microsteps",
    "YAW_SUM_MAX": "largest sum of the three arms, microsteps",
    "TILT_GAP_MIN": "text port: smallest gap, microsteps; the tilt keeps its limit if all gaps are between this and TILT_GAP_MAX",
    "TILT_GAP_MAX": "text port: largest gap, microsteps",
    "TEXT_YAW_SUM_MAX": "largest sum of the three arms for the text port, microsteps",
    "TEXT_SPEED": "speed of text motions, quarter microsteps per second",
    "SPEED_MAX": "largest speed of an arm plus 1 microstep/s, quarter microsteps per second",
    "ACCELERATION": "acceleration of an arm, Q26 microsteps per tick squared",
}
