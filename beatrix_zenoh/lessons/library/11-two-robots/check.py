"""Check of lesson 11: the check moves the leader, takes the follower for a while as the teacher, and presses STOP."""

import time

import numpy as np

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt, Seen, Stage, Unmet
from beatrix_zenoh.lessons.measures import rms
from beatrix_zenoh.lessons.picture import Panel

LEADER, FOLLOWER = "bea1", "bea2"
SIGNS = np.array([-1.0, 1.0, -1.0])
NEAR = 2.0
"""The follower is the mirror image if no angle differs by more (deg)."""
STILL = 0.5
"""A follower whose angles are smaller (deg) has not left home."""
PATIENT_S = 8.0
POSES = ((20, 0, 0), (-20, 10, 5), (0, -8, -5), (0, 0, 0))
SPEED = 30.0
END_OF_PROGRAM_S = 2.0
"""Time in which a program that gives up ends."""
END_S = 10.0
"""Time in which the program must end after STOP."""
WHEN = {
    "still": "before the leader had moved",
    "mirrors": "before the leader had moved",
    "taken": "while the teacher held bea2",
}
"""When a program had ended by itself, by the figure that was not met then."""
TIMES = ([0, 0.02, 0.04, 0.06, 0.08, 0.1], [3 + 0.02 * i for i in range(26)], [0, 0.5], [7, 8, 9.5, 10])


def check(attempt: Attempt) -> None:
    for times in TIMES:
        asked, found = (len(times) - 1) / (times[-1] - times[0]), attempt.call("rate", times)
        slips.numbers("rate", found, asked, 0.01)
        attempt.require("rate", abs(found / asked - 1) < 0.01, count=len(times), asked=asked, found=found)
    attempt.draw = mirrored
    marks: dict[str, float] = {}
    with attempt.on_stage(LEADER, FOLLOWER):
        try:
            seen = attempt.observe_all(
                robots=(LEADER, FOLLOWER), during=lambda stage: play(stage, marks), within_s=END_S
            )
        except Unmet as unmet:
            attempt.require("gone", not unmet.ended, when=WHEN.get(unmet.figure, ""))
            attempt.require("goes_on", unmet.figure != "ends", **marks, seconds=END_S)
            raise
        lag, off = delay(seen[LEADER], seen[FOLLOWER])
        attempt.require("late", lag < 0.3, lag=1000 * lag)
        attempt.require("shape", off < 3, off=off)
        attempt.require("both", marks["moved"] < 0.5, moved=marks["moved"])
        try:
            attempt.observe_all(robots=(LEADER, FOLLOWER), during=stop_leader, within_s=END_S)
        except Unmet as unmet:
            attempt.require("at_leader", unmet.figure != "ends", seconds=END_S)
            raise


def mirrored(seen):
    """Return the angles of the follower, and the mirror image of the leader."""
    leader, follower = seen[LEADER], seen[FOLLOWER]
    return [
        Panel(
            f"bea2, {name} (°)",
            follower.t,
            follower.head[:, i],
            SIGNS[i] * np.interp(follower.t, leader.t, leader.head[:, i]),
        )
        for i, name in enumerate(("yaw", "pitch", "roll"))
    ]


def play(stage: Stage, marks: dict[str, float]) -> None:
    """Be the conductor who moves the leader, the teacher who takes the follower, and the guest who presses STOP."""
    leader, follower = stage.robot(LEADER, "conductor"), stage.robot(FOLLOWER, "conductor")
    leader.look(15, 6, 4)
    wait_for_image(leader, follower, "mirrors")
    with stage.counting():
        for pose in POSES:
            leader.look(*pose, speed=SPEED)
        time.sleep(0.5)
    with stage.robot(FOLLOWER, "teacher").lease():
        try:
            leader.look(-15, 0, 0)
        except BeatrixError as error:  # the program has pressed STOP
            time.sleep(END_OF_PROGRAM_S)
            raise Unmet("taken", asked="yaw 15, pitch 0, roll 0", found=str(error)) from error
        time.sleep(1.0)
    wait_for_image(leader, follower, "taken")
    leader.look(60, 0, 0, speed=12, wait=False)
    time.sleep(1.0)
    guest = stage.robot(FOLLOWER, "guest")
    with guest.events() as events:
        guest.stop()
        time.sleep(1.0)
        before = leader.positions().head.yaw
        time.sleep(0.5)
        marks["moved"] = abs(leader.positions().head.yaw - before)
        marks["refused"] = sum(event.count for event in events.take() if event.reason == "STOPPED")
    if marks["moved"] >= 0.5:
        leader.stop()


def stop_leader(stage: Stage) -> None:
    """Press STOP at the leader, at which the program sends no motion that could be refused."""
    leader, follower = stage.robot(LEADER, "soloist"), stage.robot(FOLLOWER, "soloist")
    with leader.lease(PATIENT_S):  # the conductor was stopped, and must pause
        leader.look(15, 6, 4)
        wait_for_image(leader, follower, "mirrors")
        stage.robot(LEADER, "guest").stop()


def wait_for_image(leader, follower, figure: str) -> None:
    """Wait until the follower is the mirror image of the leader; raises Unmet."""
    deadline_s = time.monotonic() + PATIENT_S
    wanted = SIGNS * np.array(leader.positions().head)
    while np.abs(np.array(follower.positions().head) - wanted).max() > NEAR:
        if time.monotonic() > deadline_s:
            found = follower.positions().head
            if np.abs(found).max() < STILL:
                raise Unmet("still", asked=text(wanted))
            raise Unmet(figure, asked=text(wanted), found=text(found))
        time.sleep(0.1)


def text(head) -> str:
    return "yaw {:.0f}, pitch {:.0f}, roll {:.0f}".format(*head)


def delay(leader: Seen, follower: Seen) -> tuple[float, float]:
    """Return how late the follower is (s), and how far off then (deg, root mean square of the worst angle)."""
    best = (0.0, np.inf)
    for lag in np.arange(0.0, 2.0, 0.02):
        off = max(
            rms(SIGNS[i] * np.interp(follower.t - lag, leader.t, leader.head[:, i]) - follower.head[:, i])
            for i in range(3)
        )
        if off < best[1]:
            best = (float(lag), off)
    return best
