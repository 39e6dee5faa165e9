"""Lesson 5: kinematics of the neck, a coaxial 3-RRR spherical parallel mechanism. All angles are in degrees."""

# %% Geometry: the elbows are 45 deg below the horizontal, the mounts level, and every rod spans 90 deg
import numpy as np

from beatrix_zenoh import Robot

ARM_ANGLE = 45.0  # from the vertical axis, downwards, to the elbow
AZIMUTHS = (90.0, 210.0, 330.0)  # of the elbows at home: short, middle, long
MOUNT_OFFSET = 90.0  # azimuth from an elbow to its mount at home
ROD = 90.0  # angle between elbow and mount, seen from the neck centre: it never changes

np.set_printoptions(suppress=True)

POSES = ((20, 10, 0), (-30, 0, 15), (0, 20, 0), (40, -10, -10), (-15, 15, 20), (0, -20, 5))


def unit(azimuth, below):
    """Return the unit vector with an azimuth, and so many degrees from the vertical axis, downwards."""
    a, b = np.radians(azimuth), np.radians(below)
    return np.array([np.sin(b) * np.cos(a), np.sin(b) * np.sin(a), -np.cos(b)])


def rotation(yaw, pitch, roll):
    """Return Rz(yaw) Ry(pitch) Rx(roll) as a 3x3 matrix."""
    (cy, cp, cr), (sy, sp, sr) = (
        np.cos(np.radians([yaw, pitch, roll])),
        np.sin(np.radians([yaw, pitch, roll])),
    )
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return about_z @ about_y @ about_x


# %% Task 1: the closures. They are 0 if the rods fit
def closures(arms, head):
    """Return elbow . mount - cos(ROD) for short, middle and long; arms = (short, middle, long), head = (yaw, pitch, roll)."""
    turned = rotation(*head)
    return [
        unit(azimuth + arm, ARM_ANGLE) @ turned @ unit(azimuth + MOUNT_OFFSET, 90.0) - np.cos(np.radians(ROD))
        for azimuth, arm in zip(AZIMUTHS, arms, strict=True)
    ]


# %% Task 2: the inverse, in closed form
def inverse(yaw, pitch, roll):
    """Return the angles of short, middle and long for an orientation of the head."""
    turned = rotation(yaw, pitch, roll)
    sine, cosine = np.sin(np.radians(ARM_ANGLE)), np.cos(np.radians(ARM_ANGLE))
    arms = []
    for azimuth in AZIMUTHS:
        x, y, z = turned @ unit(azimuth + MOUNT_OFFSET, 90.0)
        # sine * level * cos(elbow - mount) - cosine * z = cos(ROD), with the azimuths of elbow and mount
        level = np.hypot(x, y)
        apart = np.arccos((np.cos(np.radians(ROD)) + cosine * z) / (sine * level))
        arm = np.degrees(np.arctan2(y, x) - apart) - azimuth
        arms.append((arm + 180) % 360 - 180)
    return arms


# %% Task 3: forward, by Newton's method
def forward(short, middle, long):
    """Return yaw, pitch and roll for the angles of the arms."""
    arms = np.array([short, middle, long], dtype=float)
    mean = arms.mean()
    head = np.array([mean, short - mean, (long - middle) / np.sqrt(3)])  # the rule of lesson 3
    for _ in range(20):
        error = np.array(closures(arms, head))
        small = 1e-4
        slope = np.array([(closures(arms, head + small * axis) - error) / small for axis in np.eye(3)]).T
        step = np.linalg.solve(slope, -error)
        head = head + step
        if np.abs(step).max() < 1e-9:
            break
    return head


# %% Compare with the robot
def main():
    """Move the arms to the solution for each pose, and print what the head does."""
    with Robot() as robot:
        robot.make_ready()
        for pose in POSES:
            robot.move(*inverse(*pose), speed=40)
            now = robot.positions()
            print("asked", pose, "-", now.head)
            print(
                "  closures",
                np.round(closures(now.arms, now.head), 4),
                "forward",
                np.round(forward(*now.arms), 2),
            )
        robot.home()


if __name__ == "__main__":
    main()
