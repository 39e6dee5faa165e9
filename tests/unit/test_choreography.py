"""Choreographies: what a file may hold, that ours can be danced, and in which order it is."""

from __future__ import annotations

import itertools
import math

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.choreography import Choreography, Figure, Pose, parse, play, shipped
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.kinematics import Neck
from beatrix_zenoh.limits import Limits

REST: Arms = (0.0, 0.0, 0.0)


def durations(choreography: Choreography) -> list[float]:
    """How long each of its motions takes; raises Refused for one that is not allowed."""
    neck, limits, here = Neck(), Limits(), REST
    speed = math.radians(choreography.speed)
    found = []
    for _, pose in choreography.steps:
        goal = neck.inverse(*(math.radians(angle) for angle in (pose.yaw, pose.pitch, pose.roll)))
        found.append(limits.check_motion(here, REST, goal, (speed, speed, speed), straight=True).duration)
        here = goal
    return found


def test_hello_is_allowed_fits_its_times_and_lasts_about_twenty_seconds() -> None:
    hello = shipped("hello")
    times = [pose.at for _, pose in hello.steps]
    taken = durations(hello)
    for (begin, following), duration in zip(itertools.pairwise(times), taken, strict=False):
        assert begin + duration + 0.1 < following
    assert 15 < times[-1] + taken[-1] < 22


def test_hello_ends_where_it_began() -> None:
    _, last = shipped("hello").steps[-1]
    assert (last.yaw, last.pitch, last.roll) == (0, 0, 0)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("title =", "Invalid value"),
        ('title = "x"\nspeed = 60.0\nfigure = []', "times"),
        ('title = "x"\nspeed = 60.0\n[[figure]]\ntitle = "nod"\nposes = [[0.0, 1.0]]', "length"),
        (
            'title = "x"\nspeed = 60.0\n[[figure]]\ntitle = "nod"\nposes = [[1, 0, 0, 0], [0, 0, 0, 0]]',
            "decrease",
        ),
        ('title = "x"\nspeed = 60.0\ntempo = 3\n[[figure]]\ntitle = "nod"\nposes = [[1, 0, 0, 0]]', "tempo"),
    ],
)
def test_a_file_that_cannot_be_danced_is_refused_with_what_it_should_hold(text: str, what: str) -> None:
    with pytest.raises(Refused, match=what) as refusal:
        parse(text, "mine.toml")
    assert "mine.toml" in refusal.value.message
    assert "[at, yaw, pitch, roll]" in refusal.value.message


class Recorder:
    """A stage that writes down what happens on it."""

    def __init__(self, fail_at: int | None = None) -> None:
        self.events: list[tuple[str, float]] = []
        self._fail_at = fail_at

    def preview(self, yaw: float, pitch: float, roll: float, *, speed: float | None) -> Recorder:
        assert (pitch, roll, speed) == (0, 0, 60)
        self.events.append(("preview", yaw))
        return self

    def commit(self) -> None:
        self.events.append(("commit", 0))
        if self._fail_at == len(self.events):
            raise Refused(Reason.YAW_LIMIT, "too far")


TWO_POSES = Choreography("t", 60.0, [Figure("f", [Pose(0.0, 1.0, 0, 0), Pose(0.02, 2.0, 0, 0)])])


def test_every_pose_is_previewed_before_it_is_committed() -> None:
    stage = Recorder()
    told: list[float] = []
    play(stage, TWO_POSES, lambda _, pose: told.append(pose.yaw))
    assert stage.events == [("preview", 1), ("commit", 0), ("preview", 2), ("commit", 0)]
    assert told == [1, 2]


def test_nothing_follows_a_motion_that_failed() -> None:
    stage = Recorder(fail_at=2)
    with pytest.raises(Refused):
        play(stage, TWO_POSES, lambda *_: None)
    assert len(stage.events) == 2
