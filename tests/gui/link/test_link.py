"""The link of the window: its session, and requests to one robot."""

from __future__ import annotations

import signal
import statistics
import time
from collections.abc import Iterator
from functools import partial

import pytest
from gui_links import Linked, look, short
from late_tests import in_time
from robots import Process, Stage, free_endpoint, start_router, until

from beatrix_zenoh.client import Client, Place, Presence, stopping
from beatrix_zenoh.contract._generated.messages import Command, Fault, Reason, Source
from gui.console.state.actions import ChooseRobot, MakeReady, Retry, Send, SendCommand, SendStop
from gui.console.state.world import LinkPhase, World


@pytest.mark.measures_time
def test_a_motion_of_one_robot_is_accepted_and_done(linked: Linked) -> None:
    for row, side in enumerate(("sim", "hw")):
        linked.do(Send(row, look(10), (side,)))
        accepted = linked.accepted(row, side)
        assert not accepted.done
        end = linked.end_of(row, side)
        assert (end.accepted, end.reason) == (True, Reason.OK)
        assert short(linked.world, side) == pytest.approx(10, abs=0.1)
        until(partial(recorded, linked, side), "the event")
        in_time(abs(end.duration_s - accepted.duration_s), 0.3, "duration apart from the one announced")


def recorded(linked: Linked, side: str) -> bool:
    """Return whether an event shows that the window has requested a yaw of 10 deg."""
    asked = [event.pose_query for event in linked.world.side(side).events if event.source is Source.WINDOW]
    return any(query is not None and 0.17 < query.yaw < 0.18 for query in asked)


@pytest.mark.measures_time
def test_stop_is_sent_at_once_while_the_window_is_busy(
    linked: Linked, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent_s: list[float] = []
    put = stopping.publish_stop

    def noted(client: Client, place: Place, press: bytes | None = None) -> None:
        put(client, place, press)
        sent_s.append(time.monotonic())

    monkeypatch.setattr(stopping, "publish_stop", noted)
    took_s = []
    for row in range(15):
        sent_s.clear()
        began_s = time.monotonic()
        linked.do(SendStop(row))
        while time.monotonic() < began_s + 0.03 or len(sent_s) < 2:
            linked.link.world()
        took_s.append(sent_s[0] - began_s)
    in_time(statistics.median(took_s), 0.01, "STOP, which waits for no timer of the window")
    for row in range(15):
        assert linked.end_of(row, "hw").accepted


# -- the session ----------------------------------------------------------------------------------


def test_the_link_connects_to_a_router_that_starts_later_and_again_after_its_loss() -> None:
    endpoint = free_endpoint()
    with Linked(endpoint) as linked:
        world = linked.until(lambda world: world.phase is LinkPhase.NO_ROUTER, "there is no router")
        assert f"No router at {endpoint}" in world.trouble
        for action in (SendStop(1), Send(2, look(5), ("sim", "hw"))):
            linked.do(action)
            assert linked.end_of(action.row).reason is Reason.NO_ROUTER
        router = start_router(endpoint)
        linked.do(Retry())
        linked.until(lambda world: world.phase is LinkPhase.ONLINE, "there is a router")
        with Stage() as other:
            node = other.process("hw_node", "--name", "bea", "--connect", endpoint, "--port", "virtual:")
            node.expect("ready")
            linked.online("hw")
            router.end()
            world = linked.until(lambda world: world.phase is LinkPhase.NO_ROUTER, "the router is lost")
            assert endpoint in world.trouble
            linked.do(SendStop(3))
            assert linked.end_of(3, "hw").reason is Reason.NO_ROUTER
            router = start_router(endpoint)
            try:
                linked.until(lambda world: world.phase is LinkPhase.ONLINE, "it is back")
                linked.online("hw")
                until(lambda: retried(linked), "the seat is connected again")
            finally:
                linked.close()
                node.end()
                router.end()


def retried(linked: Linked, side: str = "hw") -> bool:
    """Send `Ready` in a new row; return whether it is accepted."""
    row = 100 + len(linked.outcomes)
    linked.do(MakeReady(side, row))
    return linked.end_of(row, side).accepted


def test_the_only_name_online_is_selected_and_another_can_be_selected(stage: Stage) -> None:
    with Linked(stage.endpoint, "not-there", name_given=False) as linked:
        world = linked.until(lambda world: world.robot == "bea", "the only robot is selected")
        assert world.names == ("bea",)
        linked.online("sim", "hw")
        linked.do(ChooseRobot("other"))
        world = linked.world
        assert (world.robot, world.sim.presence) == ("other", Presence.ABSENT)
        linked.do(ChooseRobot("bea"))
        linked.online("sim", "hw")
    with Linked(stage.endpoint, "not-there") as linked:
        linked.until(lambda world: world.names == ("bea",), "bea is seen")
        assert linked.world.robot == "not-there"


# -- robots that are suspended or killed ----------------------------------------------------------


@pytest.fixture(scope="module")
def of_module() -> Iterator[tuple[Stage, Process, Process]]:
    with Stage() as stage:
        yield stage, stage.simulation("bea", "--ready"), stage.hardware("bea")


@pytest.fixture
def own(of_module: tuple[Stage, Process, Process]) -> Iterator[tuple[Stage, Process, Process]]:
    """A stage with a simulation that is ready, whose robots the test may suspend."""
    stage, *processes = of_module
    with Linked(stage.endpoint) as linked:
        linked.online("sim", "hw")
        until(lambda: retried(linked, "sim"), "the simulation is ready")
    yield of_module
    for process in processes:
        process.send(signal.SIGCONT)


@pytest.mark.measures_time
def test_a_suspended_hardware_node_delays_neither_the_simulation_nor_stop(
    own: tuple[Stage, Process, Process],
) -> None:
    stage, _, hardware = own
    with Linked(stage.endpoint) as linked:
        linked.online("sim", "hw")
        linked.do(MakeReady("hw", 1))
        assert linked.end_of(1, "hw").accepted
        hardware.send(signal.SIGSTOP)
        began_s = time.monotonic()
        linked.until(lambda world: world.hw.presence is Presence.LOST, "the node is lost")
        linked.do(Send(2, look(90, 30), ("hw",)))
        linked.do(Send(3, look(40, 30), ("sim",)))
        linked.accepted(3, "sim")
        linked.do(SendStop(4))
        assert linked.end_of(4, "sim").accepted
        assert linked.end_of(3, "sim").reason is Reason.STOPPED
        assert not linked.of(4, "hw")
        in_time(time.monotonic() - began_s, 3.0, "STOP of the simulation")
        assert linked.end_of(4, "hw").reason in (Reason.NODE_HANGS, Reason.NODE_LOST)
        linked.until(lambda world: world.latency_s["hw"] is None, "no round trip")
        assert linked.world.latency_s["sim"] is not None
        for row in (20, 21):
            linked.do(MakeReady("hw", row))
        linked.do(SendStop(5))
        assert linked.end_of(21, "hw").reason is Reason.STOPPED
        hardware.send(signal.SIGCONT)
        linked.online("hw")
        until(lambda: retried(linked), "the robot carries out requests again")


@pytest.mark.measures_time
def test_an_emergency_stop_reaches_a_moving_robot_while_the_other_one_is_suspended(
    own: tuple[Stage, Process, Process],
) -> None:
    stage, _, hardware = own
    with Linked(stage.endpoint) as linked:
        linked.online("sim", "hw")
        hardware.send(signal.SIGSTOP)
        linked.do(MakeReady("hw", 1))  # never answered
        linked.do(Send(2, look(90, 30), ("sim",)))
        linked.accepted(2, "sim")
        linked.do(SendStop(3, emergency=True))
        began_s = time.monotonic()
        assert linked.end_of(3, "sim").accepted
        linked.until(lambda world: fault_of(world) is Fault.EMERGENCY, "the motors are off")
        in_time(time.monotonic() - began_s, 1.5, "EMERGENCY STOP of the simulation")
        assert linked.end_of(2, "sim").reason is not Reason.OK
        assert linked.end_of(3, "hw").reason in (Reason.NODE_HANGS, Reason.NODE_LOST)
        hardware.send(signal.SIGCONT)
        linked.do(SendCommand(4, Command.RESET, value=True, sides=("sim",)))
        assert linked.end_of(4, "sim").accepted


def fault_of(world: World) -> Fault:
    """Return the fault of the simulation."""
    return Fault.NONE if world.sim.status is None else world.sim.status.fault


def test_close_takes_at_most_3_s_with_suspended_robots(own: tuple[Stage, Process, Process]) -> None:
    stage, simulation, hardware = own
    linked = Linked(stage.endpoint)
    linked.online("sim", "hw")
    simulation.send(signal.SIGSTOP)
    hardware.send(signal.SIGSTOP)
    linked.do(Send(1, look(20), ("sim", "hw"), 2.0))
    linked.do(MakeReady("hw", 2))
    linked.do(SendStop(3))
    linked.close()


def test_close_stops_the_motions_of_this_window(linked: Linked, stage: Stage) -> None:
    linked.do(Send(1, look(90, 20), ("hw",)))
    linked.accepted(1, "hw")
    linked.close()
    robot = stage.robot("bea", "hw", "eve")
    until(lambda: not robot.status().moving, "it rests")
    assert robot.positions().commanded.short < 60
