"""Lesson 6: the edge of what the head can reach. All angles are in degrees."""

# %% Given: the arms for a pitch, and pitch and roll of a head that leans somewhere
import math

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh.motion.kinematics import Neck

NECK = Neck()
DIRECTIONS = (30, 90, 150, 210, 270, 330)


def arms(pitch):
    """Return the angles of short, middle and long for a pitch; your functions of lesson 5 do the same."""
    return [math.degrees(arm) for arm in NECK.inverse(0.0, math.radians(pitch), 0.0)]


def lean(tilt, direction):
    """Return pitch and roll of a head that leans by `tilt`. Lowest is: 0 the nose, 90 the right ear, 270 the left ear."""
    down, way = math.sin(math.radians(tilt)), math.radians(direction)
    pitch = math.asin(down * math.cos(way))
    return math.degrees(pitch), math.degrees(math.atan2(down * math.sin(way), math.cos(math.radians(tilt))))


# %% Task 1: how fast must the fastest arm be?
def speed_ratio(pitch):
    """Return the speed of the fastest arm (deg/s) if the head pitches with 1 deg/s just at this pitch."""
    return max(abs(arm) for arm in arms(pitch)) / pitch


# %% Task 2: how far can the head lean? This one tries it, and hits the edge each time
def allowed(robot, tilt, direction):
    """Return whether the robot would go there."""
    pitch, roll = lean(tilt, direction)
    try:
        robot.look(pitch=pitch, roll=roll, speed=90)
    except Refused as refusal:
        print(refusal.message)
        return False
    return True


def edge(robot, direction):
    """Return the largest tilt that the robot allows in this direction, within 0.5 deg, and never too large."""
    tilt = 0
    while allowed(robot, tilt + 5, direction):
        tilt += 5
    return tilt


# %% Go to the edge in every direction, and home between
def main():
    """Find the edge, then lean half a degree less."""
    with Robot() as robot:
        robot.make_ready()
        for direction in DIRECTIONS:
            tilt = edge(robot, direction)
            print(f"direction {direction}: up to {tilt:.1f} degrees")
            pitch, roll = lean(tilt - 0.5, direction)
            robot.look(pitch=pitch, roll=roll, speed=90)
            robot.look(speed=90)


if __name__ == "__main__":
    main()
