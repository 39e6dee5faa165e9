"""The outside view of a simulation: drawn while a client subscribes, with a lower priority than the eyes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import pytest
from robots import Process, Stage, until
from simulated_pictures import FIRST_S, fresh

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.client import CameraImage
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.node import Node
from beatrix_zenoh.recording.subscriptions import RobotSubscriptions
from sim_node import gl
from sim_node.body import Simulation
from sim_node.renderer import HEIGHT


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as stage:
        yield stage


@pytest.fixture(scope="module")
def sim(stage: Stage) -> Process:
    return stage.simulation("bea", "--ready")


@pytest.fixture
def robot(stage: Stage, sim: Process) -> Iterator[Robot]:
    robot = stage.robot("bea", "sim")
    yield robot
    robot.look(speed=80)
    robot.client.close()


def test_the_outside_view_shows_the_head(robot: Robot) -> None:
    with robot.camera("outside") as images:
        home = fresh(images)
        assert not any(eye.streaming for eye in robot.status().cameras), (
            "no eye is drawn for the outside view"
        )
        robot.look(roll=20, speed=60)
        tilted = fresh(images)
    iris = irises(home)
    assert abs(iris[0][1] - iris[1][1]) < 15, "both irises have the same height"
    assert 60 < iris[1][0] - iris[0][0] < 160, "the face is large in the picture"
    iris = irises(tilted)
    assert iris[1][1] - iris[0][1] < -20, "the robot's right ear is down, that is at the left of the picture"


def irises(picture: npt.NDArray[np.uint8]) -> list[tuple[float, float]]:
    """Return column and row (px) of the irises of the robot's face, from the left to the right of the picture."""
    face = picture[: HEIGHT * 2 // 3]  # the rings below are blue and green
    red, green, blue = (face[..., colour].astype(int) for colour in range(3))
    rows, columns = np.nonzero((red < 50) & (green > 80) & (blue > green) & (blue < 1.4 * green))
    assert len(rows) > 200, "the face is not in the picture"
    middle = (
        columns.mean()
    )  # not the middle of the outermost pixels, because a pixel of the room may have the same colour
    return [
        (float(np.median(columns[side])), float(np.median(rows[side])))
        for side in (columns < middle, columns > middle)
    ]


def test_a_subscription_to_the_eyes_draws_no_outside_view(robot: Robot) -> None:
    with robot.camera("outside") as outside:
        first = outside.next(FIRST_S)
    with robot.camera("left") as left:
        fresh(left)
        seen = left.next(FIRST_S).seq
        until(lambda: left.next(FIRST_S).seq >= seen + 5, "five pictures of the left eye", FIRST_S)
        with robot.camera("outside") as outside:
            assert outside.next(FIRST_S).seq < first.seq + 5, "no outside view was drawn meanwhile"


def test_hardware_has_no_outside_view(stage: Stage) -> None:
    robot = stage.robot("bea", "hw")
    with pytest.raises(WrongUsage, match="Only simulations draw an outside view"):
        robot.camera("outside")


def test_a_recording_draws_no_outside_view(stage: Stage, robot: Robot) -> None:
    client = stage.client("recorder")
    with robot.camera("outside") as outside:
        first = outside.next(FIRST_S)
    subscriptions = RobotSubscriptions(client, ["bea"], cameras=True)
    eyes: set[str] = set()

    def both_arrived() -> bool:
        eyes.update(eyes_of(subscriptions))
        return len(eyes) == 2

    until(both_arrived, "pictures of both eyes", FIRST_S)
    with robot.camera("outside") as outside:
        assert outside.next(FIRST_S).seq < first.seq + 5, "no outside view was drawn meanwhile"
    assert eyes == {"left", "right"}
    subscriptions.close()


def eyes_of(subscriptions: RobotSubscriptions) -> set[str]:
    """Return the eyes of the pictures that have arrived."""
    return {
        value.eye
        for value in (arrival.value for arrival in subscriptions.take())
        if isinstance(value, CameraImage)
    }


@pytest.fixture
def slow(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> Iterator[Robot]:
    """A simulation with a higher picture rate than ray casting can draw."""
    monkeypatch.setattr(gl, "backend", lambda: None)
    node = Node(
        Sessions(lambda: zbus.connect(stage.endpoint)), "slow", Simulation("slow", eyes_hz=30)
    ).start()
    robot = stage.robot("slow", "sim")
    yield robot
    robot.client.close()
    node.close()


def test_with_ray_casting_the_eyes_have_priority(slow: Robot) -> None:
    with slow.camera("left") as left, slow.camera("outside") as outside:
        assert outside.next(FIRST_S).source == "rays"
        assert any("no OpenGL" in warning for warning in slow.status().warnings)
        left.next(FIRST_S)
        eye, view = left.next(FIRST_S).seq, outside.next(FIRST_S).seq
        until(lambda: left.next(FIRST_S).seq >= eye + 12, "a dozen pictures of the eye", FIRST_S)
        assert outside.latest is not None
        assert outside.latest.seq - view <= 7, "one for three pictures of the eye, with a tolerance"
