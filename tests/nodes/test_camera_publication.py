"""Pictures over a router: taken only while a client subscribes, with a header, and unaffected by other subscribers."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from signal import SIGKILL, SIGSTOP

import pytest
from robots import Stage, until

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind, Reason
from beatrix_zenoh.node import CameraFrame, Component, Node, StatusFields, camera_publisher
from hw_node.body import VirtualHardware

PERIOD_S = 0.02
PICTURE = b"\xff\xd8" + bytes(40_000) + b"\xff\xd9"
READER = """
import sys, time
from beatrix_zenoh import Robot
with Robot("bea", "hw", connect=sys.argv[1]) as robot, robot.camera("left") as images:
    images.next(10.0)
    print("ready", flush=True)
    time.sleep(60)
"""


class Eyes(Component):
    """Two eyes with one thread, like those of a renderer; counts the pictures, so that tests detect unneeded ones."""

    def __init__(self, node: Node) -> None:
        self._wake = threading.Event()
        self.eyes = {
            eye: camera_publisher(keys.camera(node.name, "hw", eye), node.events, "test", self._wake.set)
            for eye in ("left", "right")
        }
        self.taken = {"left": 0, "right": 0}
        self._closed = False
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self, sessions: Sessions) -> None:
        for eye in self.eyes.values():
            eye.start(sessions)
            eye.report("")
        self._thread.start()

    def contribute(self, status: StatusFields) -> None:
        for eye in self.eyes.values():
            eye.contribute(status)

    def _run(self) -> None:
        while not self._closed:
            subscribed = [name for name, eye in self.eyes.items() if eye.subscribed]
            for name in subscribed:
                self.taken[name] += 1
                self.eyes[name].publish(CameraFrame(PICTURE, 640, 480, time.monotonic_ns(), "test"))
            self._wake.wait(PERIOD_S if subscribed else 10.0)
            self._wake.clear()

    def close(self) -> None:
        self._closed = True
        self._wake.set()
        self._thread.join(timeout=5.0)


class HardwareWithEyes(VirtualHardware):
    """A virtual board with eyes."""

    eyes: Eyes

    def components(self, node: Node) -> list[Component]:
        self.eyes = Eyes(node)
        return [self.eyes]


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as stage:
        yield stage


@pytest.fixture(scope="module")
def eyes(stage: Stage) -> Iterator[Eyes]:
    body = HardwareWithEyes("bea")
    node = Node(Sessions(lambda: zbus.connect(stage.endpoint)), "bea", body).start()
    yield body.eyes
    node.close()


@pytest.fixture
def robot(stage: Stage, eyes: Eyes) -> Iterator[Robot]:
    robot = stage.robot("bea", "hw")
    yield robot
    robot.client.close()


def idle(eyes: Eyes) -> Callable[[], bool]:
    return lambda: not any(eye.subscribed for eye in eyes.eyes.values())


def test_pictures_are_taken_only_while_a_client_subscribes(eyes: Eyes, robot: Robot) -> None:
    until(idle(eyes), "no subscriber of the previous test is left")
    before = dict(eyes.taken)
    with robot.camera("left") as first, robot.camera("left") as second:
        first.next(5.0)
        second.next(5.0)
        first.close()
        for _ in range(5):
            second.next(5.0)
    until(idle(eyes), "the last subscriber has gone")
    assert eyes.taken["right"] == before["right"], "no picture of the right eye"
    eyes._wake.set()  # a wake-up without a subscriber takes no picture
    taken = eyes.taken["left"]
    robot.status()
    robot.status()
    assert eyes.taken["left"] <= taken + 1, "one picture may have been in preparation"


def test_a_suspended_subscriber_delays_no_other_subscriber(
    eyes: Eyes, stage: Stage, robot: Robot, tmp_path: Path
) -> None:
    with robot.camera("left") as images:
        images.next(5.0)
        program = tmp_path / "reader.py"
        program.write_text(READER)
        reader = stage.script(program, stage.endpoint)
        reader.expect("ready")
        reader.send(SIGSTOP)
        try:
            images.take()
            first, dropped = images.next(5.0).seq, images.dropped
            seqs = [images.next(1.0).seq for _ in range(100)]
            lost = seqs[-1] - first - len(seqs)
            # On a busy machine this reader itself may be late and drop pictures; these do not count.
            assert lost - (images.dropped - dropped) <= 5, "a subscriber that reads loses few pictures"
        finally:
            reader.end(SIGKILL)  # the exit code of the suspended subscriber does not matter


def test_a_lost_camera_is_an_event_and_a_warning(eyes: Eyes, robot: Robot) -> None:
    trouble = "The cable is out: plug it in."
    with robot.events(timeout_s=10.0) as events:
        until(lambda: robot.stop().result and bool(events.take(0.2)), "events arrive here")
        eyes.eyes["right"].report(trouble)
        eyes.eyes["right"].report(trouble)
        status = robot.status()
        assert (status.cameras[1].connected, status.cameras[1].trouble) == (False, trouble)
        assert f"right eye: {trouble}" in status.warnings
        eyes.eyes["right"].report("")
        lost, found = islice((event for event in events if event.kind is EventKind.CAMERA), 2)
    assert (lost.kind, lost.action, lost.reason) == (EventKind.CAMERA, "right", Reason.FAULT)
    assert (found.reason, found.message) == (Reason.OK, "right eye: connected again.")
