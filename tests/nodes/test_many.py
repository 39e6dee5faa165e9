"""Several simulations in one process: each behaves as alone, and one does not disturb the others."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from floods import Flood
from robots import Process, Stage, ready, until
from shell import beatrix

from beatrix_zenoh import Interrupted
from beatrix_zenoh.contract._generated import keys
from sim_node.app import chosen

NAMES = ("ada", "bob", "cem")


@pytest.fixture(scope="module")
def many() -> Iterator[Stage]:
    with Stage() as stage:
        start(stage)
        yield stage


def start(stage: Stage, *options: str) -> Process:
    """Start one process that simulates all robots of NAMES."""
    words = [word for name in NAMES for word in ("--name", name)]
    process = stage.process("sim_node", *words, "--connect", stage.endpoint, *options)
    for name in NAMES:
        process.expect(f"ready {keys.alive(name, 'sim')}")
    return process


def test_each_robot_has_its_own_state_and_driver(many: Stage) -> None:
    ada, bob = many.robot("ada", "sim", "ana"), many.robot("bob", "sim", "ben")
    for robot, seat, yaw in ((ready(ada), "ana", 10), (ready(bob), "ben", -10)):
        motion = robot.look(yaw=yaw, speed=20, wait=False)
        assert robot.status().holder == seat
        motion.result(20)
    assert [round(robot.positions().head.yaw) for robot in (ada, bob)] == [10, -10]
    assert not many.robot("cem", "sim").status().enabled
    many.close_clients()


def test_a_robot_stops_while_another_is_flooded(many: Stage) -> None:
    ada, cem = ready(many.robot("ada", "sim")), ready(many.robot("cem", "sim", "cleo"))
    with Flood(cem) as flood:
        until(lambda: flood.sent > 200, "flooded")
        motion = ada.look(yaw=40, speed=20, wait=False)
        until(lambda: ada.status().moving, "ada moves")
        ada.stop()
        with pytest.raises(Interrupted):
            motion.result(10)
        assert abs(ada.positions().head.yaw) < 39
    assert cem.stop().result
    many.close_clients()


def test_a_second_process_may_not_take_a_name(many: Stage) -> None:
    second = beatrix("sim", "--name", "dan", "--name", "bob", "--connect", many.endpoint)
    assert second.returncode == 1
    assert "A sim robot named 'bob' is already online" in second.stderr
    with many.client() as client:
        robots = client.bus.robots()
    assert ("bob", "sim") in robots
    assert ("dan", "sim") not in robots
    many.close_clients()


def test_a_signal_ends_all_robots(alone: Stage) -> None:
    process = start(alone)
    with alone.client() as client:
        assert client.bus.robots() == [(name, "sim") for name in NAMES]
        assert process.end() == 0
        until(lambda: client.bus.robots() == [], "all robots are gone")


@pytest.mark.parametrize("options", [("--legacy", "COM4"), ("--view",)])
def test_impossible_options_are_refused(options: tuple[str, ...]) -> None:
    assert beatrix("sim", "--name", "ada", "--name", "bob", *options).returncode == 2


def test_a_robot_that_is_named_twice_is_simulated_once() -> None:
    _, names = chosen(["ada", "bob", "ada"], None, None)
    assert names == ["ada", "bob"]
