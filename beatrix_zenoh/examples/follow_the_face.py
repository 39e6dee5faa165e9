"""Follow the face: the head turns to the person that its left eye sees. Copy this program, and change what you like.

python follow_the_face.py           the simulation
python follow_the_face.py hw        the robot
python follow_the_face.py hw sim    both; the eye is that of the first
"""

# %% What you may change
import math
import sys
from collections import deque

import numpy as np

from beatrix_zenoh import Robot

GAIN = 3.0  # 1/s: how fast the head turns, for each degree that is missing
FASTEST = 28.0  # deg/s
LEAST = 0.5  # deg: the robots get no request for a smaller turn
REACH_YAW, REACH_PITCH = 60.0, 18.0  # deg: the head turns no further
VIEW = 60.0  # deg from the top to the bottom of a picture
LOST = 2.0  # s without a person, after which the head looks straight ahead
PATIENCE = 15.0  # s without a picture, after which the program ends; the first one may take long


# %% Where the person is in a picture
def find_face(picture):
    """Return column and row of the largest face, or None; needs OpenCV 4: pip install "opencv-python-headless<5"."""
    if DETECTOR is None:
        return None
    grey = np.ascontiguousarray(picture.mean(axis=2).astype(np.uint8))
    faces = DETECTOR.detectMultiScale(grey, scaleFactor=1.2, minNeighbors=5, minSize=(30, 30))
    if len(faces) == 0:
        return None
    left, top, width, height = max(faces, key=lambda face: face[2] * face[3])
    return left + width / 2, top + height / 2


def find_cap(picture):
    """Return column and row of the face below a magenta cap, as the person of the simulation wears one, or None."""
    red, green, blue = (picture[..., i].astype(int) for i in range(3))
    rows, columns = np.nonzero((red > 100) & (green < 60) & (blue > 60) & (red > blue + 30))
    if len(rows) < red.size / 2000:  # less is something else
        return None
    below = 0.8 * math.sqrt(len(rows))  # the face is below the cap
    return np.median(columns), np.median(rows) + below  # a few other pixels do not move the median


def find_person(picture):
    """Return the angles to the left and down (deg) from the middle of a picture to the person, or None."""
    place = find_face(picture) or find_cap(picture)
    if place is None:
        return None
    height, width, _ = picture.shape
    focus = height / 2 / math.tan(math.radians(VIEW / 2))  # distance of the picture from the eye, in pixels
    across, down = place[0] - (width - 1) / 2, place[1] - (height - 1) / 2
    return -math.degrees(math.atan(across / focus)), math.degrees(math.atan(down / focus))


def face_detector():
    """Return the face detector that comes with OpenCV 4, or None."""
    try:
        import cv2

        return cv2.CascadeClassifier(cv2.data.haarcascades + "haarcascade_frontalface_default.xml")
    except (ImportError, AttributeError):  # not installed, or OpenCV 5
        return None


DETECTOR = face_detector()


# %% The loop: picture, person, step, motion
def within(most, angle):
    """Return the angle, at most `most` to both sides."""
    return max(-most, min(most, angle))


def step(missing, dt):
    """Return how far (deg) the head turns in the time dt (s), if it still misses the person by `missing` (deg)."""
    return within(FASTEST * dt, GAIN * missing * dt)


def follow(robots):
    """Turn the heads of all robots after the person that the first one sees."""
    with robots[0].stream() as positions, robots[0].camera("left", timeout_s=PATIENCE) as pictures:
        readings = deque([positions.next()], maxlen=200)
        last = seen_at = readings[0].t
        yaw, pitch, _ = readings[0].head
        goal = sent = yaw, pitch
        for image in pictures:
            readings.extend(positions.take())
            t = image.t_mono_ns / 1e9
            dt, last = min(0.2, max(0.0, t - last)), t
            seen = find_person(image.array())
            if seen is not None:  # the person is there, from where the head looked when the picture was taken
                times = [reading.t for reading in readings]
                head_yaw = np.interp(t, times, [reading.head.yaw for reading in readings])
                head_pitch = np.interp(t, times, [reading.head.pitch for reading in readings])
                seen_at = t
                goal = within(REACH_YAW, head_yaw + seen[0]), within(REACH_PITCH, head_pitch + seen[1])
            elif t - seen_at > LOST:
                goal = 0.0, 0.0
            yaw += step(goal[0] - yaw, dt)
            pitch += step(goal[1] - pitch, dt)
            if max(abs(yaw - sent[0]), abs(pitch - sent[1])) >= LEAST:
                sent = yaw, pitch
                for robot in robots:
                    robot.look(yaw=yaw, pitch=pitch, wait=False)


if __name__ == "__main__":
    print("Looking for", "a magenta cap." if DETECTOR is None else "a face, or a magenta cap.", flush=True)
    robots = [Robot(side=side) for side in sys.argv[1:] or ["sim"]]
    try:
        for robot in robots:
            if robot.side == "sim":  # you make the hardware ready yourself, when its head is upright
                robot.make_ready()
        follow(robots)
    except KeyboardInterrupt:
        for robot in robots:
            robot.stop()
    finally:
        for robot in robots:
            robot.close()
