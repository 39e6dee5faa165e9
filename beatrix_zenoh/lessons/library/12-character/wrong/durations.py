# expects: scene
"""Lesson 12, a character: the head plays a scene. A line is a pose: time, yaw, pitch, roll, speed, name."""

# %% The scene: change it
from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import choreography, play
from beatrix_zenoh.client.motion_file import parse

SCENE = """
t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure
0.0,0,15,0,20,sleepy
3.0,0,18,8,20,
2.0,0,15,-8,20,
3.0,0,-10,0,40,surprised
2.0,20,-10,10,40,
2.5,-20,-12,0,30,proud
3.0,0,0,0,30,
"""

# %% Play it
if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        play(robot, choreography(parse(SCENE, "scene")))
