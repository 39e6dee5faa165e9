import numpy as np

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.lessons.measures import rms
from beatrix_zenoh.lessons.picture import Panel

WAY, TOP, ACCELERATION = 30, 30, 180
TIME = WAY / TOP + TOP / ACCELERATION
DT = 0.002
MIDDLE, JERK = 24, 1500
STREAMED = (0.8, 1.4)


def check(attempt: Attempt) -> None:
    t = np.arange(-0.1, 2.0, DT)
    angle = np.array([attempt.call("angle", time) for time in t.tolist()])
    asked = np.interp(t, *trapezoid())
    attempt.panels = [
        Panel("angle (°)", t, angle, asked),
        Panel("°/s", t, np.gradient(angle, DT), np.gradient(asked, DT)),
    ]
    slips.numbers("angle", angle[-1], WAY, 0.01)
    attempt.require(
        "goal", abs(angle[0]) < 0.01 and abs(angle[-1] - WAY) < 0.01, first=angle[0], last=angle[-1]
    )
    steps = np.abs(np.diff(angle))
    at = int(steps.argmax())
    attempt.require("jump", steps[at] < 1, jump=steps[at], t=t[at])
    speed = np.diff(angle) / DT
    change = np.diff(speed) / DT
    at = int(np.abs(change).argmax())
    attempt.require(
        "acceleration", abs(change[at]) < ACCELERATION * 1.05, change=abs(change[at]), t=abs(t[at])
    )
    attempt.require("top", abs(speed.max() - TOP) < 0.05 * TOP, top=speed.max())
    attempt.require("back", speed.min() > -0.1, back=-speed.min())
    end = t[int((angle > WAY - 0.002).argmax())]
    attempt.require("duration", abs(end - TIME) < 0.02, end=end, wanted=TIME)

    run = attempt.bench("angle", seconds=2, speed=60)
    commanded = run.commanded[:, 0]
    speed = np.gradient(commanded, run.t)
    slowest = speed[(commanded > 6) & (commanded < 24)].min()
    attempt.require("middle", slowest > MIDDLE, slowest=slowest)
    jerk = rms(np.gradient(np.gradient(speed, run.t), run.t))
    attempt.require("jerk", jerk < JERK, jerk=jerk)

    attempt.draw = lambda robots: [
        Panel("yaw (°)", one.t, one.yaw, zones=((WAY - 0.5, WAY + 0.5),)) for one in robots.values()
    ]
    seen = attempt.observe()
    turned = float(seen.yaw.max())
    attempt.require("robot", abs(turned - WAY) < 0.5, turned=turned)
    began, ended = (float(seen.t[int((seen.yaw > yaw).argmax())]) for yaw in (1, WAY - 1))
    took = ended - began
    attempt.require("stream", STREAMED[0] < took < STREAMED[1], took=took)


def trapezoid():
    """Return times (s) and angles (deg) of the motion that is asked."""
    t = np.arange(0, TIME + DT, DT)
    speed = np.minimum(TOP, ACCELERATION * np.minimum(t, TIME - t).clip(0))
    return t, np.cumsum(speed) * DT
