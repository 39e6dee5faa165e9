"""Router lost, frozen, late, forgetful: nobody drives on unheard, and everybody comes back."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh
from stage import Stage, free_endpoint, ready, until

from beatrix_zenoh import Interrupted, NoAnswer, Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client import Client
from beatrix_zenoh.node import Node, Roads
from beatrix_zenoh.settings import Settings
from hw_node.body import VirtualHardware


@pytest.fixture
def stage() -> Iterator[Stage]:
    """A router of one's own."""
    with Stage() as made:
        yield made


def refused(robot: Robot) -> bool:
    """Try a motion."""
    try:
        robot.look(yaw=1, speed=60)
    except (Refused, NoAnswer):
        return True
    return False


def test_router_killed_and_restarted_everybody_is_back(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    router = zbus.open_router(endpoint)
    node = Node(Roads.open(lambda: zbus.connect(endpoint)), "bea", VirtualHardware("bea"))
    client = Client(Settings("bea", endpoint, "ana"))
    robot = ready(Robot("bea", "hw", client=client))
    robot.look(yaw=30, wait=False)
    router.close()
    try:
        until(lambda: not node.reporter.status().moving, "a client cut off is a client lost: stopped", 3.0)
        router = zbus.open_router(endpoint)
        until(lambda: client.bus.robots(0.3) == [("bea", "hw")], "back on line", 10.0)
        assert robot.status().calibrated, "the robot itself lost nothing"
        until(lambda: not refused(robot), "the seat is known again", 5.0)
    finally:
        client.close()
        node.close()
        router.close()


def test_router_process_killed_and_restarted_everybody_is_back(stage: Stage) -> None:
    endpoint = free_endpoint()
    router = stage.process("beatrix_zenoh.cli", "router", "--listen", endpoint)
    router.expect("ready")
    node = stage.process("sim_node", "--name", "bea", "--connect", endpoint, "--ready")
    node.expect("ready")
    with Robot("bea", "sim", connect=endpoint, who="ana") as robot:
        motion = robot.look(yaw=30, wait=False)
        router.end(signal.SIGKILL)
        with pytest.raises(NoAnswer, match="has gone, so robots end their motions"):
            motion.wait()
        node.expect(f"The router at {endpoint} has gone: motions are ended")
        with pytest.raises(NoAnswer, match="has gone, so robots end their motions"):
            robot.look(yaw=4)
        again = stage.process("beatrix_zenoh.cli", "router", "--listen", endpoint)
        again.expect("ready")
        until(lambda: robot.client.bus.robots(0.3) == [("bea", "sim")], "back on line", 10.0)
        node.expect(f"The router at {endpoint} is there again.")
        until(lambda: not refused(robot), "the seat is known again", 5.0)


def test_node_started_before_the_router_waits_for_it(stage: Stage) -> None:
    endpoint = free_endpoint()
    process = stage.process("hw_node", "--name", "bea", "--connect", endpoint, "--port", "virtual:")
    assert f"`beatrix router --listen {endpoint}`" in process.expect("No router at")
    router = zbus.open_router(endpoint)
    process.expect("ready beatrix/bea/hw/@alive")
    process.end()
    router.close()


def test_ctrl_c_ends_a_node_that_waits_for_its_router(stage: Stage) -> None:
    process = stage.process("hw_node", "--name", "bea", "--connect", free_endpoint(), "--port", "virtual:")
    process.expect("No router at")
    process.send(signal.SIGINT)
    assert process.wait(5) == 0


def test_a_frozen_router_is_a_lost_one(stage: Stage) -> None:
    endpoint = free_endpoint()
    router = stage.process("beatrix_zenoh.cli", "router", "--listen", endpoint)
    router.expect("ready")
    node = Node(Roads.open(lambda: zbus.connect(endpoint)), "bea", VirtualHardware("bea"))
    try:
        with Robot("bea", "hw", connect=endpoint, who="ana") as robot:
            ready(robot).look(yaw=150, speed=20, wait=False)
            router.send(signal.SIGSTOP)
            until(lambda: not node.reporter.status().moving, "stopped after the lease of 2 s", 4.0)
            assert 0 < node.driver.arms()[0] < 2.0
            router.send(signal.SIGCONT)
            until(lambda: not refused(robot), "everybody is back", 10.0)
    finally:
        node.close()


@pytest.mark.parametrize("road", ["commands", "motions", "questions"])
def test_a_session_that_the_router_has_forgotten_is_renewed(stage: Stage, road: str) -> None:
    node = stage.node("bea")
    robot = ready(stage.robot("bea", "hw"))
    stream = robot.stream()
    robot.look(yaw=2)
    motion = robot.look(yaw=170, speed=10, wait=False)
    bus = getattr(node._roads, road)
    forgotten = bus._session
    for declared in [*bus._declared, *bus._tokens.values()]:
        if not isinstance(declared, zenoh.Publisher):
            declared.undeclare()  # as after a reconnection that lost them
    until(lambda: any("connected anew" in warning for warning in node.driver.warnings), "noticed", 10.0)
    until(lambda: bool(forgotten.is_closed()), "nothing is left of it")
    until(lambda: not node.reporter.status().moving, "its asker may wait in vain: stopped")
    with pytest.raises((Interrupted, NoAnswer)):
        motion.wait()
    until(lambda: not node.driver.holder, "free")
    stream.take(0)
    robot.look(yaw=4)
    assert robot.stop().result
    assert robot.status().warnings
    assert stream.take(2.0)
    assert robot.client.bus.robots() == [("bea", "hw")]
