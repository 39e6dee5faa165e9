# expects: figures
"""Lesson 12, a character: the head plays a scene. A line is a pose: time, yaw, pitch, roll, speed, name."""

# %% The scene: change it
from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import choreography, play
from beatrix_zenoh.client.motion_file import parse

SCENE = """
t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure
0.0,25,0,0,40,no
0.9,-25,0,0,,
2.4,0,0,0,,
4.0,25,0,0,,no
4.9,-25,0,0,,
6.4,0,0,0,,
8.0,25,0,0,,no
8.9,-25,0,0,,
10.4,0,0,0,,
"""

# %% Play it
if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        play(robot, choreography(parse(SCENE, "scene")))
