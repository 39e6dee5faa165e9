"""Plays of files, poses and gestures: read and checked as a whole before anything moves."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from beatrix_zenoh.client import choreography, motion_file
from beatrix_zenoh.client.choreography import ArmPose, Choreography, Step, play
from beatrix_zenoh.client.degrees import RobotInfo
from beatrix_zenoh.client.motion_file import MotionFile
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.link.outcomes import WindowError, accepted
from gui.console.link.request import BOTH, Program, Report
from gui.console.state.actions import LARGEST_BYTES, POSES, Play
from gui.console.state.refusals import wrong_file


class Playing(Program):
    """One play."""

    def __init__(self, action: Play, robots: Twin | Robot) -> None:
        """Store the arguments."""
        super().__init__(action.row, action.sides, BOTH if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self.title = action, robots, action.title
        self._both = (robots.sim, robots.hw) if isinstance(robots, Twin) else (robots,)
        self._lead_s = action.lead_s if isinstance(robots, Twin) else 0.0
        self.pose = -1
        """number of the pose of the window that began last, from 0; -1: none"""

    def run(self, report: Report) -> str:
        """Check all of the play, then play it.

        Raises:
            Refused: a robot would refuse a part of the play.
            NoAnswer: a robot does not answer.
        """
        found = read(self._action)
        self.check()
        infos = [robot.info() for robot in self._both]
        if isinstance(found, Choreography):
            self._dance(found, infos, report)
        else:
            self._follow(found, infos, report)
        return f"{self.title}: played."

    def _dance(self, found: Choreography, infos: list[RobotInfo], report: Report) -> None:
        from beatrix_zenoh.paths.follow import robots_of  # noqa: PLC0415  # numpy would delay the window
        from beatrix_zenoh.paths.path import check_choreography  # noqa: PLC0415

        action, rounds = self._action, [found]
        if action.gesture:
            rounds = [found.at_most(min(info.limits.speed_default for info in infos))]
        for robot in robots_of(infos):
            check_choreography(_poses((*action.poses, *action.again)) if action.again else rounds[0], robot)
            self.check()
        lasts_s = found.steps[-1][1].at
        repeated = itertools.repeat(_poses(action.again)) if action.again else ()
        for number, steps in enumerate(itertools.chain(rounds, repeated)):
            told = accepted(self.row, self.side, f"{self.title}: checked.", lasts_s)
            report(replace(told, rounds=number))
            self.pose = -1
            play(self._robots, steps, self._begun, lead_s=self._lead_s, check=self.check)

    def _begun(self, _title: str, _pose: Step) -> None:
        """Count the poses of the window that have begun."""
        self.pose += bool(self._action.poses)

    def _follow(self, found: MotionFile, infos: list[RobotInfo], report: Report) -> None:
        """Play a path; raises WindowError for one that is no path or too long, Refused if it is out of reach."""
        from beatrix_zenoh.motion.limits import MotionLimits  # noqa: PLC0415  # numpy would delay the window
        from beatrix_zenoh.paths.follow import follow, robots_of  # noqa: PLC0415
        from beatrix_zenoh.paths.path import LONGEST_S, path_of  # noqa: PLC0415
        from beatrix_zenoh.paths.replay import replay  # noqa: PLC0415

        file, checked = Path(found.source).name, robots_of(infos)
        if len(found.points) < 2:
            raise WindowError(Reason.BAD_VALUE, "result.one_point", file=file)
        try:
            path = path_of(found, MotionLimits(checked[0]))
        except WrongUsage as error:
            raise unusable(error, file) from error
        if path.duration_s > LONGEST_S:
            raise WindowError(
                Reason.BAD_VALUE, "result.too_long", file=file, seconds=path.duration_s, allowed=LONGEST_S
            )
        self.check()
        following, *_ = [follow(path, robot) for robot in checked]
        self.check()
        report(accepted(self.row, self.side, f"{self.title}: checked.", following.path.duration_s))
        replay(self._robots, following, lambda _passed_s: self.check(), lead_s=self._lead_s)


def _poses(poses: Iterable[ArmPose]) -> Choreography:
    steps: list[tuple[str, Step]] = [(POSES, pose) for pose in poses]
    return Choreography(steps)


def read(action: Play) -> Choreography | MotionFile:
    """Return the choreography or path to play; raises WindowError if its file cannot be used."""
    if action.gesture:
        return choreography.shipped(action.gesture)
    file = action.file
    if file is None:
        return _poses(action.poses)
    try:
        size = file.stat().st_size
        if size > LARGEST_BYTES:
            mb, most_mb = size / 1e6, LARGEST_BYTES / 1e6
            raise WindowError(Reason.BAD_VALUE, "result.too_large", file=str(file), size=mb, allowed=most_mb)
        found = motion_file.read(file)
        return choreography.choreography(found) if found.with_speed else found
    except OSError as error:
        raise WindowError(Reason.BAD_VALUE, "result.no_read", file=str(file)) from error
    except WrongUsage as error:
        raise unusable(error, file.name) from error


def unusable(error: WrongUsage, file: str) -> WindowError:
    """Return the error of a file that cannot be played."""
    key, slots = wrong_file(error, file)
    return WindowError(Reason.BAD_VALUE, key, None, **slots)
