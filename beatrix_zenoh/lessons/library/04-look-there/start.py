"""Lesson 4: look at a place in the room. Places in metres, angles in degrees."""

# %% From a place to two angles
import math

from beatrix_zenoh import Robot

EYE_HEIGHT = 0.144  # the eyes are so much above the centre of the neck (m)


def bearing(x, y, z):
    """Return yaw and pitch with which the eyes look at the place x (ahead), y (left), z (up)."""
    yaw = math.atan2(x, y)
    pitch = 0
    return yaw, pitch


# %% Look at the person, wherever the person is
def main():
    """Turn the head to the person and stay there."""
    with Robot() as robot:
        robot.make_ready()
        person = robot.target()
        print(f"the person is at x {person.x:.2f} m, y {person.y:.2f} m, z {person.z:.2f} m")
        yaw, pitch = bearing(person.x, person.y, person.z)
        print(f"so look to yaw {yaw:.1f}, pitch {pitch:.1f} degrees")
        robot.look(yaw=yaw, pitch=pitch)
        print(robot.positions().head)


if __name__ == "__main__":
    main()
