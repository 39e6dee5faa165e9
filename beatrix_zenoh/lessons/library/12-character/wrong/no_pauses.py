# expects: figures
"""Lesson 12, a character: the head plays a scene. A line is a pose: time, yaw, pitch, roll, speed, name."""

# %% The scene: change it
from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import choreography, play
from beatrix_zenoh.client.motion_file import parse

SCENE = """
t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure
0.0,20,0,0,40,one
1.0,20,10,0,40,
1.6,-20,10,0,40,two
2.8,-20,-10,10,40,
3.7,20,-10,10,40,three
5.0,20,10,-10,40,
6.2,-20,10,-10,40,
7.5,-20,-10,10,40,
8.7,20,-10,10,40,
10.0,20,10,0,40,
10.8,0,0,0,40,
"""

# %% Play it
if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        play(robot, choreography(parse(SCENE, "scene")))
