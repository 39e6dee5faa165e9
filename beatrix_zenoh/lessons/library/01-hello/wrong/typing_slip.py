# expects: runs
# A slip in a name.
from beatrix_zenoh import Robot

robot = Robot()
robot.look(pich=10)
