"""Plays of poses and gestures: read and checked as a whole before anything moves."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from beatrix_zenoh.client import choreography, motion_file, own_gestures
from beatrix_zenoh.client.choreography import GESTURES, ArmPose, Choreography, Step, play
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.outcomes import WindowError, accepted
from gui.console.link.own_gestures import read as read_gesture
from gui.console.link.request import BOTH, Program, Report
from gui.console.link.sounds import Sounds
from gui.console.state.actions import POSES, Play
from gui.console.state.refusals import wrong_file


class Playing(Program):
    """One play."""

    def __init__(
        self,
        action: Play,
        robots: Twin | Robot,
        sounds: Sounds | None = None,
        own: tuple[Path, ...] = (),
    ) -> None:
        """Store the arguments; without sounds it is silent; `own`: folders of gestures besides that of the user."""
        super().__init__(action.row, action.sides, BOTH if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self._own, self.title = action, robots, own, action.title
        self._sounds = sounds
        self._track: Path | None = None
        """what is heard from the first pose of each round on; None: nothing"""
        self._both = (robots.sim, robots.hw) if isinstance(robots, Twin) else (robots,)
        self.pose = -1
        """number of the pose of the window that began last, from 0; -1: none"""

    def run(self, report: Report) -> str:
        """Check all of the play, then play it.

        Raises:
            Refused: a robot would refuse a part of the play.
            NoAnswer: a robot does not answer.
        """
        from beatrix_zenoh.paths.follow import robots_of  # noqa: PLC0415  # numpy would delay the window
        from beatrix_zenoh.paths.path import check_choreography  # noqa: PLC0415

        action, found = self._action, read(self._action, *self._own)
        self.check()
        infos = [robot.info() for robot in self._both]
        if action.gesture in GESTURES:
            found = found.at_most(min(info.limits.speed_default for info in infos))
        for robot in robots_of(infos):
            check_choreography(_poses((*action.poses, *action.again)) if action.again else found, robot)
            self.check()
        try:
            if self._sounds is not None and action.poses:
                self._track = self._sounds.track([pose.at for pose in action.poses], action.notes)
            self._play(found, report)
        finally:
            self._silence()
            if self._track is not None:
                self._track.unlink(missing_ok=True)
        return f"{self.title}: played."

    def _play(self, found: Choreography, report: Report) -> None:
        """Play what was checked, as often as the action says."""
        action, lasts_s = self._action, found.steps[-1][1].at
        repeated = itertools.repeat(_poses(action.again)) if action.again else ()
        for number, steps in enumerate(itertools.chain([found], repeated)):
            told = accepted(self.row, self.side, f"{self.title}: checked.", lasts_s)
            report(replace(told, rounds=number))
            self.pose = -1
            play(self._robots, steps, self._begun, lead_s=action.lead_s, check=self.check)

    def end(self, why: BeatrixError | None) -> None:
        """End it and the music at once."""
        super().end(why)
        self._silence()

    def _silence(self) -> None:
        if self._sounds is not None:
            self._sounds.silence()

    def _begun(self, _title: str, _pose: Step) -> None:
        """Count the poses of the window that have begun."""
        self.pose += bool(self._action.poses)
        if self._sounds is not None and self._track is not None and self.pose == 0 and not self.ends:
            self._sounds.play(self._track)


def _poses(poses: Iterable[ArmPose]) -> Choreography:
    steps: list[tuple[str, Step]] = [(POSES, pose) for pose in poses]
    return Choreography(steps)


def read(action: Play, *own: Path) -> Choreography:
    """Return the choreography to play; raises WindowError if the file of a gesture of the user cannot be used."""
    name = action.gesture
    if not name:
        return _poses(action.poses)
    if name in GESTURES:
        return choreography.shipped(name)
    file = own_gestures.file_of(name, *own)
    if file is None:
        raise WindowError(Reason.BAD_VALUE, "result.no_gesture", name=name)
    found = read_gesture(file)
    if found.wrong is not None:
        key, slots = wrong_file(found.wrong, file.name)
        raise WindowError(Reason.BAD_VALUE, key, None, **slots) from found.wrong
    return choreography.choreography(motion_file.parse(found.text, file.name))
