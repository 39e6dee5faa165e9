"""Check of lesson 9."""

import math
import time
import tomllib
from pathlib import Path

import numpy as np
import numpy.typing as npt
import simplejpeg

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt, Stage, Unmet
from beatrix_zenoh.lessons.bench import Bench, Course
from beatrix_zenoh.lessons.measures import rms
from beatrix_zenoh.lessons.checking import BUSY_CORES
from beatrix_zenoh.lessons.picture import Panel
from beatrix_zenoh.lessons.phrases import NotMeasurable, busy

PICTURES = Path(__file__).parent / "files"
NOBODY = "nobody"
FOCUS = 60 / math.tan(math.radians(30))
"""Of the pictures, which are 120 pixels high and show 60 deg (pixels)."""
DELAY_S = 0.06
"""Age of an error: of a picture from its exposure to its use."""
JUMP = 20.0
WAIT_S = 4.0
"""Before the jump, so that sums that a controller keeps are forgotten."""
LIVE_S = 16.0
FACE = 10.0
"""Largest distance with real pictures (deg). The solution is 3 to 4 deg off, a head at rest 28."""
CATCH_UP_S = 4.0
"""Time from the first motion of the program to the first distance that counts."""
FIRST_S, LAST_S = 6.0, 10.0
"""Earliest and latest such time: a busy computer needs seconds to start the program."""
PICTURE_MS = 20.0
"""Longest processor time of `bearing`."""
SLOWEST, LONGEST_GAP_S = 5.0, 0.25
"""Pictures a second that a check with pictures needs, and the longest time between two of them."""


def check(attempt: Attempt) -> None:
    picture_ms = bearings(attempt)
    begun = run(attempt, lambda _t: JUMP, 0.6)
    attempt.require("towards", begun.yaw[-1] > 0.5, yaw=begun.yaw[-1])
    jump = run(attempt, lambda t: 0.0 if t < WAIT_S else JUMP, WAIT_S + 5)
    over = (jump.yaw.max() / JUMP - 1) * 100
    attempt.require("overshoot", over < 10, over=over)
    left = np.abs(jump.yaw - JUMP)[jump.t > WAIT_S + 3].max()
    attempt.require("arrives", left < 1, left=left)
    walk = run(attempt, lambda t: 40 * math.sin(math.tau * t / 12), 24)
    off = rms((walk.course - walk.yaw)[walk.t > 12])
    attempt.require("follows", off < 2.5, off=off)
    attempt.panels = ()
    live(attempt, picture_ms)


def bearings(attempt: Attempt) -> float:
    """Require the bearings of all pictures; return the processor time (ms) of one."""
    used: list[float] = []
    people: list[tuple[float, float, Path]] = []
    known = tomllib.loads((PICTURES / "bearings.toml").read_text(encoding="utf-8"))
    for name, bearing in known.items():
        file = PICTURES / f"{name}.jpg"
        found = attempt.value("bearing", simplejpeg.decode_jpeg(file.read_bytes()))
        used.append(1000 * attempt.used_s)
        if bearing == NOBODY:
            attempt.require("nobody", found is None or str(found) == "nan", found=found, file=file)
            continue
        attempt.require("missed", found is not None, file=file, bearing=bearing)
        if isinstance(found, bool) or not isinstance(found, int | float):
            raise Unmet("returns", function="bearing", value=repr(found)[:60], wanted="an angle in degrees")
        people.append((found, bearing, file))
    slips.numbers("bearing", [found for found, *_ in people], [bearing for _, bearing, _ in people], 1.0)
    for found, bearing, file in people:
        values = {"found": found, "bearing": bearing, "file": file}
        pixels = FOCUS * math.tan(math.radians(bearing))
        attempt.require("pixels", abs(bearing) < 5 or abs(abs(found) - abs(pixels)) > 2, **values)
        attempt.require("bearing", abs(found - bearing) <= 1, **values)
    return float(np.median(used))


def run(attempt: Attempt, course: Course, seconds: float) -> Bench:
    try:
        found = attempt.bench("step", course=course, seconds=seconds, delay_s=DELAY_S, result="rate")
        attempt.panels = [Panel("yaw (°)", found.t, found.yaw, found.course)]
        return found
    except Unmet as unmet:
        if unmet.figure == "refused":
            raise Unmet("swings", **unmet.values) from None
        raise


def live(attempt: Attempt, picture_ms: float) -> None:
    places: list[tuple[float, float]] = []
    drawn: list[float] = []

    def during(stage: Stage) -> None:
        robot = stage.robot()
        begin = time.monotonic()
        with robot.camera("left") as pictures:
            while (now := time.monotonic() - begin) < LIVE_S:
                place = robot.target()
                places.append((now, math.degrees(math.atan2(place.y, place.x))))
                drawn.extend(image.t_mono_ns / 1e9 - begin for image in pictures.take())
                time.sleep(0.1)

    try:
        seen = attempt.observe(path="sway", seconds=LIVE_S + 0.5, during=during)
    except NotMeasurable:
        light(attempt, picture_ms)
        raise
    times, person = np.array(places).T
    moved = next((at_s for at_s, _ in seen.motions), 0.0)
    first = min(max(FIRST_S, moved + CATCH_UP_S), LAST_S)
    counts = (seen.t > first) & (seen.t < LIVE_S)
    off = rms(np.interp(seen.t[counts], times, person) - seen.yaw[counts])
    attempt.panels = [Panel("yaw (°)", seen.t, seen.yaw, np.interp(seen.t, times, person))]
    if off >= FACE:
        light(attempt, picture_ms)
        enough(np.array([moment for moment in drawn if first < moment < LIVE_S]), first)
        slips.motions([seen])
    attempt.require("face", off < FACE, off=off)


def light(attempt: Attempt, picture_ms: float) -> None:
    """Require that the program itself leaves time to the robot: what it uses is no fault of a busy computer."""
    share = f"your program itself used {attempt.cores:.1f} of a core; " if attempt.cores > BUSY_CORES else ""
    fast = picture_ms <= PICTURE_MS and attempt.cores <= BUSY_CORES
    if not fast:
        attempt.doubt = None
    attempt.require("slow", fast, share=share, took=picture_ms, allowed=PICTURE_MS)


def enough(drawn: npt.NDArray[np.float64], first: float) -> None:
    """Raise NotMeasurable if too few pictures were drawn from `first` (s) on."""
    rate = len(drawn) / (LIVE_S - first)
    if rate < SLOWEST:
        raise busy(f"It drew {rate:.1f} pictures a second; {SLOWEST:.0f} are needed.")
    gap = float(np.diff(drawn).max())
    if gap > LONGEST_GAP_S:
        raise busy(f"For {gap:.2f} s it drew no picture; {LONGEST_GAP_S} s are allowed.")
