"""Lesson 11, two robots: the follower is the mirror image of the leader. End it with STOP at either robot."""

# %% Settings, and the functions that `beatrix lesson check 11` calls
import time

from beatrix_zenoh import Refused, Robot

LEADER, FOLLOWER = "bea1", "bea2"


def rate(times):
    """Return the number of messages a second, from the times (s) at which they came; a list of two or more."""
    return len(times) / (times[-1] - times[0])


def mirrored(head):
    """Return yaw, pitch and roll (deg) of the mirror image of a head."""
    return head.yaw, head.pitch, head.roll


# %% Mirror until STOP
def mirror(leader, follower):
    """Let the follower be the mirror image of the leader."""
    while True:
        head = leader.positions().head  # asks once; leader.stream() would be told 50 times a second
        yaw, pitch, roll = mirrored(head)
        follower.look(yaw, pitch, roll)
        time.sleep(1.0)


if __name__ == "__main__":
    with Robot(LEADER) as leader, Robot(FOLLOWER) as follower:
        leader.make_ready()
        follower.make_ready()
        mirror(leader, follower)
