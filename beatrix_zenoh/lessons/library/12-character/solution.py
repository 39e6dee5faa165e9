"""Lesson 12, a character: the head plays a scene. A line is a pose: time, yaw, pitch, roll, speed, name."""

# %% The scene: change it
from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import choreography, play
from beatrix_zenoh.client.motion_file import parse

SCENE = """
t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure
# a shy robot: it wakes, discovers you, is frightened, becomes curious, and goes home
0.0,0,18,0,20,asleep
2.0,0,20,4,8,
3.2,0,16,-4,8,
5.5,0,-6,0,25,wakes
7.5,25,-4,0,30,looks for you
9.0,-20,-4,0,30,
11.3,-28,12,8,40,is frightened
13.8,-10,8,14,12,is curious
15.6,0,0,16,15,
18.0,0,0,0,25,goes home
"""

# %% Play it
if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        play(robot, choreography(parse(SCENE, "scene")))
