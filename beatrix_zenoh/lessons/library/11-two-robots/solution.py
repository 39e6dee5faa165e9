"""Lesson 11, two robots: the follower is the mirror image of the leader. End it with STOP at either robot."""

# %% Settings, and the functions that `beatrix lesson check 11` calls
import time

from beatrix_zenoh import Refused, Robot

LEADER, FOLLOWER = "bea1", "bea2"


def rate(times):
    """Return the number of messages a second, from the times (s) at which they came; a list of two or more."""
    return (len(times) - 1) / (times[-1] - times[0])


def mirrored(head):
    """Return yaw, pitch and roll (deg) of the mirror image of a head."""
    return -head.yaw, head.pitch, -head.roll


# %% Mirror until STOP
def mirror(leader, follower):
    """Let the follower be the mirror image of the leader."""
    with leader.stream() as positions, leader.events() as one, follower.events() as other:
        while not any(event.kind == "stop" for event in one.take() + other.take()):
            newest = [positions.next(), *positions.take()][-1]
            yaw, pitch, roll = mirrored(newest.head)
            try:
                follower.look(yaw, pitch, roll, wait=False)
            except Refused as refusal:
                if refusal.reason == "STOPPED":
                    break
                if refusal.reason != "NOT_HOLDER":
                    raise
                time.sleep(0.2)  # another seat drives the follower: try again later
    print("STOP was pressed: both robots rest.")
    leader.stop()
    follower.stop()


if __name__ == "__main__":
    with Robot(LEADER) as leader, Robot(FOLLOWER) as follower:
        leader.make_ready()
        follower.make_ready()
        mirror(leader, follower)
