# expects: radians
"""Lesson 2: from the steps of a motor to the degrees of an arm."""

import time

from beatrix_zenoh import Robot

# %% What is written on the parts
FULL_STEPS = 200  # full steps of the motor for one turn of its axle
MICROSTEPS = 8  # the driver divides each full step into so many microsteps
MOTOR_TEETH = 26  # teeth of the small wheel on the motor
ARM_TEETH = 68  # teeth of the large wheel on the arm


# %% Your formulas
def steps_per_turn():
    """Microsteps of the motor for one turn of the arm."""
    return FULL_STEPS * MICROSTEPS * ARM_TEETH / MOTOR_TEETH


def degrees_per_step():
    """Angle of the arm for one microstep, in degrees."""
    return 6.283 / steps_per_turn()


def steps_for(degrees):
    """The whole number of microsteps that comes closest to an angle of the arm."""
    return round(degrees / degrees_per_step())


def degrees_for(steps):
    """The angle of the arm after so many microsteps, in degrees."""
    return steps * degrees_per_step()


# %% Move all three arms together: the head turns as far as the arms do
def main():
    robot = Robot()
    robot.make_ready()
    for asked in range(3, 31, 3):
        arm = degrees_for(steps_for(asked))
        robot.move(arm, arm, arm)
        time.sleep(0.3)  # let the arm come to rest
        measured = robot.positions().arms.short
        print(f"asked {asked:2} degrees, {steps_for(asked):3} steps, measured {measured:6.3f} degrees")
    arm = arm + degrees_for(1)  # the smallest move
    robot.move(arm, arm, arm)
    time.sleep(0.3)
    print(f"one step more: {robot.positions().arms.short:6.3f} degrees")
    robot.home()


if __name__ == "__main__":
    main()
