"""`beatrix replay`: follow the path of a motion file or a recording in time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.client import motion_file
from beatrix_zenoh.client.degrees import FASTEST, SLOWEST, RobotInfo, checked_factor, robot_of
from beatrix_zenoh.contract.errors import BeatrixError, wrong_usage
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.output import note, progress_bar
from beatrix_zenoh.recording.verbs.files import RECORDING, only, read_recording
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Json, Lead, Name, On, Who, finite
from beatrix_zenoh.terminal.targets import (
    check_lead,
    one_or_twin,
    open_robots,
    show_positions,
    stop_on_interrupt,
)

if TYPE_CHECKING:  # importing numpy would delay `beatrix --help` by 0.1 s
    from beatrix_zenoh.paths.follow import Following
    from beatrix_zenoh.paths.path import ArmPath
    from beatrix_zenoh.recording.samples import Recorded

LONG_S = 60.0
"""Length of a path (s) above which a note is printed before the check, which then takes seconds."""


def replay(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A motion file (CSV), or a recording (.rrd).")],
    speed_factor: Annotated[
        float,
        typer.Option(
            metavar="F",
            help=f"Replay this many times as fast, from {SLOWEST:g} to {FASTEST:g}: 0.5 takes twice the time.",
        ),
    ] = 1.0,
    lead: Lead = 0.0,
    begin: Annotated[
        float,
        typer.Option(
            "--from", min=0.0, metavar="S", callback=finite, help="Begin at this time of the file, seconds."
        ),
    ] = 0.0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Replay a recorded motion. The whole path is checked before a robot moves; Ctrl-C stops the robots.

    docs/how-to/motion-files.md explains the file format.
    """
    from beatrix_zenoh.paths.replay import replay as perform

    checked_factor(speed_factor)
    check_lead(lead, on)
    path_for = read_path(file)
    with open_robots(resolve(name, connect, who), on, acts=True) as robots:
        infos = [robot.info() for robot in robots]
        path = path_for(robots[0].name, infos[0]).beginning(begin)
        following = plan_path(path.at_speed(speed_factor), infos)
        with (
            stop_on_interrupt(robots, as_json=as_json),
            progress(following) as passed,
            one_or_twin(robots) as both,
        ):
            perform(both, following, passed, lead_s=lead)
        show_positions(robots, as_json=as_json)


def read_path(file: Path) -> Callable[[str, RobotInfo], ArmPath]:
    """Read a recording or a motion file; return a function that makes the path for a robot of this name and limits.

    Raises:
        WrongUsage: there is no such file, or a motion file cannot be read.
        Refused: BAD_VALUE, a recording cannot be read.
    """
    if file.suffix == RECORDING:
        found = read_recording(file)
        return lambda name, _info: recorded_path(found, file, name)
    from beatrix_zenoh.paths.path import path_of

    try:
        read = motion_file.read(file)
    except OSError as error:
        raise wrong_usage(
            f"{file} cannot be read: {error.strerror}. Name a motion file or a recording."
        ) from error
    return lambda _name, info: path_of(read, MotionLimits(robot_of(info)))


def recorded_path(found: Recorded, file: Path, name: str) -> ArmPath:
    """Return the recorded path of the robot of this name, or of the only robot; that of the simulation if there is one.

    Raises:
        Refused: the recording contains several robots, and none of this name.
    """
    from beatrix_zenoh.paths.path import path_of_recording
    from beatrix_zenoh.recording.series import of_samples

    sides = dict(sorted(found.robots))  # the simulation, if there is one
    chosen, side = only(sides.items(), name if name in sides else None, None, "positions of")
    samples = found.robots[chosen, side]
    arms = of_samples(samples, int(samples.time_ns[0])).arms
    return path_of_recording(f"{file}, {chosen} ({side})", arms.t, arms.angles)


def plan_path(path: ArmPath, infos: list[RobotInfo]) -> Following:
    """Plan and check the whole path for each robot, print a summary, and return the plan for the first robot.

    Raises:
        Refused: the path exceeds a limit or is too fast; the message names line and time.
        WrongUsage: the path is too long.
    """
    from beatrix_zenoh.paths.follow import follow, robots_of

    if path.duration_s > LONG_S:
        note(f"Checking a path of {path.duration_s:.0f} s.")
    following, *_ = [follow(path, robot) for robot in robots_of(infos)]
    note(
        f"Checked: {following.path.duration_s:.1f} s, {len(following.targets)} targets; the arms stay within "
        f"{following.off_deg:.1f}° of the path."
    )
    return following


@contextmanager
def progress(following: Following) -> Iterator[Callable[[float], None]]:
    """Yield a function that shows the time passed; if the block raises, print a note with the option that continues."""
    latest_s = 0.0

    def show(passed_s: float) -> None:
        nonlocal latest_s
        latest_s = passed_s
        if bar is not None:
            bar(passed_s)

    try:
        with progress_bar("Replay", following.path.duration_s) as bar:
            yield show
    except (BeatrixError, KeyboardInterrupt):
        if 0.0 < latest_s < following.path.duration_s:
            given_s = following.path.given_s(latest_s)
            note(f"The replay ended at {given_s:.1f} s; --from {given_s:.1f} continues there.")
        raise
