"""A stage that stays up between checks: `lesson watch` waits for it once only."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Final, Self

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lessons.phrases import Tell
from beatrix_zenoh.lessons.stage import PUPIL, Stage, open_stage

LEASE_S: Final = 5.0
"""Longest wait (s) for a robot that something of the last program still holds."""
Place = tuple[float, float, float]
"""x, y, z (m) as of `Robot.target`"""


class KeptStage:
    """The newest stage of all checks in a `with` block; call it like `open_stage`.

    A stage that cannot be tidied, for example because the program has frozen the robot, is replaced by a new one.
    """

    def __init__(self) -> None:
        self._open = ExitStack()
        self._stage: Stage | None = None
        self._key: tuple[object, ...] = ()
        self._path = "still"
        self._places: dict[str, Place] = {}
        """where the person of each robot was at the beginning"""
        self._used = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    @contextmanager
    def __call__(
        self, names: Sequence[str], path: str, robot_file: Path | None, tell: Tell
    ) -> Iterator[Stage]:
        """Yield a stage whose robots are ready and at home."""
        key = (tuple(names), path, robot_file)
        if key != self._key:
            self.close()
        self.tidy()
        if self._stage is None:
            self._stage = self._open.enter_context(open_stage(names, path, robot_file, tell))
            self._key, self._path = key, path
            people = {name: watch.robot.target() for name, watch in self._stage.watches.items()}
            self._places = {name: (person.x, person.y, person.z) for name, person in people.items()}
        self._used = True
        yield self._stage

    def close(self) -> None:
        """End the stage; the next call opens another one."""
        self._stage, self._key, self._used = None, (), False
        self._open.close()

    def tidy(self) -> None:
        """Undo what a program has left behind, or end the stage if that is not possible."""
        stage = self._stage
        if stage is None or not self._used:
            return
        try:
            tidied = all(tidy(stage, name, place, self._path) for name, place in self._places.items())
        except BeatrixError:
            tidied = False
        if tidied:
            self._used = False
        else:
            self.close()


def tidy(stage: Stage, name: str, place: Place, path: str = "still") -> bool:
    """Bring a robot home, and the person back to their place or path; return whether the robot is as at the beginning.

    It is asked as the pupil: what hinders the pupil now, such as a lease, a freeze or a pause, would hinder the program.
    Raises BeatrixError if the robot refuses.
    """
    robot = stage.robot(name, PUPIL)
    with closing(robot.client), robot.lease(wait_s=LEASE_S):
        robot.make_ready()
        robot.home()
        if path == "still":
            robot.move_target(*place)
        else:
            robot.walk_target(path)
        robot.play_sound("silence")
        return robot.status().speed_limit == 0
