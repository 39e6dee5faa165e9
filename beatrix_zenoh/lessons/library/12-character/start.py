"""Lesson 12, a character: the head plays a scene. A line is a pose: time, yaw, pitch, roll, speed, name."""

# %% The scene: change it
from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import choreography, play
from beatrix_zenoh.client.motion_file import parse

SCENE = """
t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure
0.0,30,0,0,90,look around
1.0,-30,0,0,90,
2.0,30,0,0,90,
3.0,-30,0,0,90,
"""

# %% Play it
if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        play(robot, choreography(parse(SCENE, "scene")))
