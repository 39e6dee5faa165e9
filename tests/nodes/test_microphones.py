"""Microphones of a node: clients see when they are on, and a lost client or device has a defined outcome."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import pytest
from robots import Stage, until, wait_status

from beatrix_zenoh import NoAnswer, Robot
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Reason, Status
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.node import SensorFrame, sensors, sound_block
from hw_node.body import VirtualHardware
from hw_node.microphones import microphone_sensor


class FakeDevice(sensors.SensorSource):
    """Microphones whose blocks come every 20 ms."""

    name = "device"

    def __init__(self) -> None:
        self.opened = self.closed = 0
        self.error: Exception | None = None

    def open(self) -> None:
        self.opened += 1

    def next(self, timeout_s: float) -> SensorFrame | None:
        if self.error is not None:
            raise self.error
        threading.Event().wait(min(timeout_s, 0.02))
        return sound_block(bytes(3840), time.monotonic_ns(), self.name)

    def close(self) -> None:
        self.closed += 1


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> FakeDevice:
    monkeypatch.setattr(sensors, "CHECK_S", 0.05)
    return FakeDevice()


@pytest.fixture
def robot(router: Stage, device: FakeDevice) -> Iterator[Robot]:
    router.node("bea", VirtualHardware("bea", sensors=[lambda node: microphone_sensor(node, device)]))
    robot = router.robot("bea", "hw")
    wait_status(robot, lambda status: status.microphones is not None, "there are microphones")
    yield robot
    robot.client.close()
    router.end_nodes()


def on(status: Status) -> bool:
    return status.microphones is not None and status.microphones.streaming


def trouble(robot: Robot) -> str:
    status = robot.status().microphones
    return "" if status is None else status.trouble


def told(robot: Robot) -> list[Event]:
    return [event for event in robot.past_events() if event.kind is EventKind.MICROPHONES]


def test_events_show_when_the_microphones_are_on_and_off(robot: Robot, device: FakeDevice) -> None:
    assert told(robot) == []
    robot.listen(0.1)
    wait_status(robot, lambda status: not on(status), "they are off")
    first, second = told(robot)
    assert (first.action, first.message) == ("on", "The microphones are on: a client listens.")
    assert (second.action, second.message) == ("off", "The microphones are off.")
    assert device.opened == device.closed == 1


def test_a_fault_of_a_device_is_shown_until_it_delivers_again(robot: Robot, device: FakeDevice) -> None:
    """The fault must not disappear with each attempt to open the device, and a mistake does not end the node."""
    device.error = NoAnswer(Reason.FAULT, "It is used by another program.")
    with robot.microphones() as sound:  # which has no block from before the fault
        until(lambda: device.opened >= 3, "it is tried again")
        assert trouble(robot) == "It is used by another program."
        device.error = KeyError("a mistake")
        until(lambda: "The device failed: 'a mistake'" in trouble(robot), "the mistake is shown")
        device.error = None
        sound.next()
        assert trouble(robot) == ""
    assert [event.message for event in told(robot) if event.reason is Reason.FAULT] == [
        "microphones: It is used by another program.",
        "microphones: The device failed: 'a mistake'. The node retries every second.",
    ]


def test_a_robot_without_microphones_says_what_to_do(router: Stage) -> None:
    router.node("ben", VirtualHardware("ben", sensors=()))
    robot = router.robot("ben", "hw")
    assert robot.status().microphones is None
    with (
        robot.microphones() as sound,
        pytest.raises(NoAnswer, match="start its node with `beatrix hw --microphones"),
    ):
        sound.next(0.1)
    router.end_nodes()


@pytest.mark.parametrize("seconds", [0, -1.0, float("nan"), 61])
def test_listen_refuses_a_useless_time(robot: Robot, seconds: float) -> None:
    with pytest.raises(WrongUsage, match="seconds"):
        robot.listen(seconds)
