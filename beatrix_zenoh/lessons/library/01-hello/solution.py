"""Lesson 1: yes, no, and one thing that the head refuses."""

from beatrix_zenoh import Refused, Robot

# %% Connect to the robot
robot = Robot()
robot.make_ready()

# %% Yes
for _ in range(2):
    robot.look(pitch=15)
    robot.look(pitch=-5)
robot.home()

# %% No
for _ in range(2):
    robot.look(yaw=25)
    robot.look(yaw=-25)
robot.home()

# %% Ask for too much, and read the answer
try:
    robot.look(pitch=60)
except Refused as refusal:
    print(refusal)

robot.home()
