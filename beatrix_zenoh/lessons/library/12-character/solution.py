"""Lesson 12, a character: the head plays a scene. A line is a pose: time, yaw, pitch, roll, speed, name."""

# %% The scene: change it
from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import choreography, play
from beatrix_zenoh.client.motion_file import parse

SCENE = """
t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure
# a shy robot: it wakes, discovers you, is frightened, becomes curious, and goes home
0.0,0,18,0,30,asleep
2.0,0,-6,0,30,wakes
4.0,25,-4,0,30,looks for you
5.4,-20,-4,0,30,
8.0,-28,12,8,40,is frightened
9.8,-10,8,14,20,is curious
12.0,0,0,0,30,goes home
"""

# %% Play it
if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        play(robot, choreography(parse(SCENE, "scene")))
