# expects: ends
# Nods for ever.
from beatrix_zenoh import Robot

robot = Robot()
while True:
    robot.look(pitch=10)
    robot.look(pitch=-10)
