"""Files and poses to play, read and checked as a whole before anything moves."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from pathlib import Path

from beatrix_zenoh.client import choreography, motion_file
from beatrix_zenoh.client.choreography import ArmPose, Choreography, Step, play
from beatrix_zenoh.client.motion_file import MotionFile
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.paths.follow import follow, robots_of
from beatrix_zenoh.paths.path import LONGEST_S, ArmPath, check_choreography, path_of
from beatrix_zenoh.paths.replay import replay
from gui.console.link.outcomes import WindowError
from gui.console.state.actions import LARGEST_BYTES, POSES, Play
from gui.console.state.refusals import wrong_file


def prepared(
    action: Play,
    robots: Twin | Robot,
    check: Callable[[], None],
    played: Callable[[int], None] = lambda _rounds: None,
    posed: Callable[[int], None] = lambda _number: None,
) -> tuple[float, Callable[[], None]]:
    """Check a play for each robot; return its least duration (s) and the function that performs it.

    `check` is called many times a second during the play; an error that it raises ends the play. `played` is called
    after each round of a play that repeats, with the number of rounds; `posed` when a pose of a choreography begins, with
    its number from 0.

    Raises:
        WrongUsage: the file is too large or cannot be read.
        Refused: a robot would refuse a part of the play.
        NoAnswer: a robot does not answer.
    """
    found = read(action)
    check()
    both = (robots.sim, robots.hw) if isinstance(robots, Twin) else (robots,)
    lead_s = action.lead_s if len(both) > 1 else 0.0
    infos = [robot.info() for robot in both]
    checked = robots_of(infos)
    if isinstance(found, Choreography):
        if action.gesture:
            found = found.at_most(min(info.limits.speed_default for info in infos))
        for robot in checked:
            check_choreography(_poses((*action.poses, *action.again)) if action.again else found, robot)
            check()
        lasts_s = found.steps[-1][1].at

        def play_once(steps: Choreography) -> None:
            numbers = itertools.count()
            play(robots, steps, lambda _title, _pose: posed(next(numbers)), lead_s=lead_s, check=check)

        def perform() -> None:
            play_once(found)
            for rounds in itertools.count(1) if action.again else ():
                played(rounds)
                play_once(_poses(action.again))

        return lasts_s, perform
    path = _path(found, MotionLimits(checked[0]))
    check()
    following, *_ = [follow(path, robot) for robot in checked]
    return following.duration_s, lambda: replay(robots, following, lambda _passed_s: check(), lead_s=lead_s)


def _path(found: MotionFile, limits: MotionLimits) -> ArmPath:
    """Return the path of a file; raises WindowError for one that is no path or too long, Refused if it is out of reach."""
    file = Path(found.source).name
    if len(found.points) < 2:
        raise WindowError(Reason.BAD_VALUE, "result.one_point", file=file)
    try:
        path = path_of(found, limits)
    except WrongUsage as error:
        key, slots = wrong_file(error, file)
        raise WindowError(Reason.BAD_VALUE, key, None, **slots) from error
    if path.duration_s > LONGEST_S:
        raise WindowError(
            Reason.BAD_VALUE, "result.too_long", file=file, seconds=path.duration_s, allowed=LONGEST_S
        )
    return path


def _poses(poses: Iterable[ArmPose]) -> Choreography:
    steps: list[tuple[str, Step]] = [(POSES, pose) for pose in poses]
    return Choreography(steps)


def read(action: Play) -> Choreography | MotionFile:
    """Return the choreography or path to play; raises WindowError or WrongUsage if its file cannot be used."""
    if action.gesture:
        return choreography.shipped(action.gesture)
    if action.file is None:
        return _poses(action.poses)
    try:
        size = action.file.stat().st_size
        if size > LARGEST_BYTES:
            raise WindowError(
                Reason.BAD_VALUE,
                "result.too_large",
                file=str(action.file),
                size=size / 1e6,
                allowed=LARGEST_BYTES / 1e6,
            )
        found = motion_file.read(action.file)
        return choreography.choreography(found) if found.with_speed else found
    except OSError as error:
        raise WindowError(Reason.BAD_VALUE, "result.no_read", file=str(action.file)) from error
    except WrongUsage as error:
        key, slots = wrong_file(error, action.file.name)
        raise WindowError(Reason.BAD_VALUE, key, None, **slots) from error
