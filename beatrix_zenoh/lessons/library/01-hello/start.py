"""Lesson 1: yes, no, and one thing that the head refuses."""

from beatrix_zenoh import Refused, Robot

# %% Connect to the robot
robot = Robot()
robot.make_ready()

# %% Yes: does this look like a nod?
robot.look(roll=15)
robot.look(roll=-5)
robot.home()

# %% No
robot.look(yaw=25)
robot.look(yaw=-25)
robot.home()

# %% Ask for too much, and read the answer
try:
    robot.look(yaw=30)
except Refused as refusal:
    print(refusal)

robot.home()
