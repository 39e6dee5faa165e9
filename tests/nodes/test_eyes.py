"""The eyes of a simulation over a router: drawn while a client subscribes, correct, without effect on the robot."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import pytest
import simplejpeg
from robots import Process, Stage, children, until

from beatrix_zenoh import Robot
from beatrix_zenoh.client import CameraImage
from beatrix_zenoh.client.subscription import Subscription
from beatrix_zenoh.contract._generated.messages import Reason
from sim_node import eyes, gl
from sim_node.body import Simulation
from sim_node.renderer import HEIGHT, WIDTH
from sim_node.target import HOME

FIRST_S = 60.0
"""Longest wait (s) for the first picture, for which the node tests and starts a renderer."""


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
    robot.move_target(*HOME)
    robot.client.close()


def renderers(process: int) -> list[int]:
    return [number for number, command in children(process).items() if "sim_node.renderer" in command]


def fresh(images: Subscription[CameraImage]) -> npt.NDArray[np.uint8]:
    """Return a picture that was taken after this call; shape (height, width, 3)."""
    now_ns = time.monotonic_ns()
    while (image := images.next(FIRST_S)).t_mono_ns <= now_ns:
        pass
    assert (image.width, image.height) == (WIDTH, HEIGHT)
    picture: npt.NDArray[np.uint8] = simplejpeg.decode_jpeg(image.jpeg)
    return picture


def person(picture: npt.NDArray[np.uint8]) -> tuple[float, float]:
    """Return column and row (px) of the middle of the person's cap and collar."""
    red, green, blue = (picture[..., colour].astype(int) for colour in range(3))
    rows, columns = np.nonzero((red > 100) & (green < 60) & (blue > 60))
    assert len(rows) > 200, "the person is not in the picture"
    return float(columns.mean()), float(rows.mean())


def test_the_picture_follows_the_person(robot: Robot) -> None:
    with robot.camera("right") as images:
        before = person(fresh(images))
        reply = robot.move_target(1.1, 0.3, 0.25)
        assert (reply.x, reply.y, reply.z) == pytest.approx((1.1, 0.3, 0.25))
        column, row = person(fresh(images))
    assert column < before[0] - 80
    assert row < before[1] - 20
    assert robot.target() == reply


@pytest.mark.long("waits for a renderer that hangs")
def test_a_renderer_that_crashes_or_hangs_affects_only_the_pictures(stage: Stage) -> None:
    sim = stage.simulation("hurt", "--ready")
    robot = stage.robot("hurt", "sim")
    with robot.camera("left") as images:
        source = images.next(FIRST_S).source
        motion = robot.look(yaw=40, wait=False)
        (renderer,) = renderers(sim.pid)
        os.kill(renderer, signal.SIGKILL)
        fresh(images)
        assert images.next(FIRST_S).source == source, "the pictures are drawn as before"
        assert motion.result(10.0).result
        assert robot.positions().head.yaw == pytest.approx(40, abs=0.5)
        (renderer,) = renderers(sim.pid)
        os.kill(renderer, signal.SIGSTOP)
        robot.look(yaw=30)
        until(lambda: robot.status().cameras[0].trouble == eyes.NO_RENDERER, "it hangs", FIRST_S)
        fresh(images)
        assert not any(eye.trouble for eye in robot.status().cameras)
        assert renderer not in renderers(sim.pid)
    assert sim.end() == 0


@pytest.fixture
def inside(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> Iterator[Robot]:
    """A simulation in this process with short retries."""
    monkeypatch.setattr(eyes, "IDLE_S", 0.1)
    monkeypatch.setattr(eyes, "RETRY_S", 0.1)
    stage.node("inside", Simulation("inside"))
    robot = stage.robot("inside", "sim")
    yield robot
    robot.client.close()
    stage.end_nodes()


def test_without_opengl_the_status_says_what_to_install(
    inside: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gl, "backend", lambda: None)
    with inside.camera("left"):
        until(lambda: inside.status().cameras[0].trouble == eyes.NO_OPENGL, "the eye has a reason")


def test_the_renderer_ends_soon_after_the_last_subscriber(inside: Robot) -> None:
    with inside.camera("left") as images:
        images.next(FIRST_S)
        assert len(renderers(os.getpid())) == 1
    until(lambda: renderers(os.getpid()) == [], "the process has ended")
    with inside.camera("right") as images:
        assert images.next(FIRST_S).seq == 1


def test_simulations_of_one_process_share_a_renderer_that_the_last_of_them_ends(stage: Stage) -> None:
    both = stage.process("sim_node", "--name", "one", "--name", "two", "--connect", stage.endpoint)
    both.expect("ready beatrix/two/")
    one, two = stage.robot("one", "sim"), stage.robot("two", "sim")
    two.move_target(0.8, 0.4, 0.0)
    with one.camera("left") as of_one, two.camera("left") as of_two:
        seen_by_one, seen_by_two = fresh(of_one), fresh(of_two)
        assert len(renderers(both.pid)) == 1
        assert not np.array_equal(seen_by_one, seen_by_two), "each sees its own person"
    assert both.end() == 0


def test_without_a_display_the_viewer_prints_one_sentence_and_returns_1(stage: Stage) -> None:
    with pytest.MonkeyPatch.context() as environment:
        environment.delenv("DISPLAY", raising=False)
        environment.delenv("WAYLAND_DISPLAY", raising=False)
        process = stage.process("sim_node", "--name", "seen", "--connect", stage.endpoint, "--view")
    assert process.wait(30) == 1
    (line,) = process.lines
    assert "no window can be opened" in line
    assert "Omit --view" in line


@pytest.fixture
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A virtual screen."""
    if shutil.which("Xvfb") is None:
        pytest.skip("no virtual screen on this machine")
    words = ["Xvfb", "-displayfd", "1", "-screen", "0", "640x480x24", "-nolisten", "tcp"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as screen:
        assert screen.stdout is not None
        monkeypatch.setenv("DISPLAY", f":{screen.stdout.readline().strip()}")
        yield
        screen.terminate()


@pytest.fixture(scope="module")
def counted() -> Iterator[Stage]:
    """A stage with coverage, because only these tests run the code of the window."""
    with Stage(traced=True) as stage:
        yield stage


@pytest.mark.long("a window on a virtual screen")
@pytest.mark.usefixtures("display")
def test_closing_the_window_does_not_disturb_the_robot(counted: Stage) -> None:
    sim = counted.simulation("shown", "--ready", "--view")
    robot = counted.robot("shown", "sim")
    ((window, command),) = children(sim.pid).items()
    assert "sim_node.viewer" in command
    assert any("key 4 shows the mechanism" in line for line in sim.lines)
    motion = robot.look(yaw=10, speed=60, wait=False)
    os.kill(window, signal.SIGKILL)
    assert motion.result(10.0).result
    assert robot.positions().head.yaw == pytest.approx(10, abs=0.5)
    assert sim.end() == 0


def test_stop_ends_a_motion_while_the_eyes_draw(robot: Robot) -> None:
    with robot.camera("left") as left, robot.camera("right") as right:
        left.next(FIRST_S)
        right.next(FIRST_S)
        motion = robot.look(yaw=90, wait=False)
        until(lambda: robot.positions().head.yaw > 2, "the head moves")
        robot.stop()
        ended = motion.exception(FIRST_S)
        assert ended is not None
        assert ended.reason is Reason.STOPPED
        at = robot.positions().head.yaw
        assert 2 < at < 60
        left.take()
        left.next(FIRST_S)
        assert robot.positions().head.yaw == pytest.approx(at, abs=0.2)
