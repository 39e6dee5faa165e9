# expects: rolls
# The nod is a roll, twice as often.
from beatrix_zenoh import Robot

robot = Robot()
for _ in range(3):
    robot.look(roll=12)
    robot.look(roll=-12)
robot.home()
