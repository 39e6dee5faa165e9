# expects: nods
# One nod only, and a small one.
from beatrix_zenoh import Robot

robot = Robot()
robot.look(pitch=10)
robot.look(pitch=5)
robot.home()
