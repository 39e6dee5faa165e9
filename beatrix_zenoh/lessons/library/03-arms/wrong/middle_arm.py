# expects: leans
"""Lesson 3: from three arms to the head. All angles are in degrees."""

# %% The arms of the table in lesson.md: short, middle, long
from beatrix_zenoh import Robot

TABLE = ((9, 0, 0), (0, 9, 0), (0, 0, 9), (9, 9, 9), (0, -9, 9))


# %% Your rule. This one says: each arm has an axis of the head for itself. Is that so?
def rule(short, middle, long):
    """Return yaw, pitch and roll of the head for the angles of the three arms."""
    yaw = (short + middle + long) / 3
    pitch = (2 * short - middle - long) / 3
    roll = (long - middle) / 3**0.5
    return yaw, pitch, roll


# %% Your arms for a nod
def arms_for_nod(pitch):
    """Return short, middle and long that pitch the head by `pitch`, with no yaw and no roll."""
    return -pitch / 2, pitch, -pitch / 2


# %% Try both with the robot
def main():
    """Compare the rule with the head, then nod."""
    with Robot() as robot:
        robot.make_ready()
        print("arms                  rule says             head does")
        for arms in TABLE:
            robot.move(*arms)
            said, done = rule(*arms), robot.positions().head
            print(*(f"{angle:5.1f}" for angle in (*arms, *said, *done)))
        robot.move(*arms_for_nod(12))
        print("nod:", robot.positions().head)
        robot.home()


if __name__ == "__main__":
    main()
