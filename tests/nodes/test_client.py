"""The client layer with a node on the virtual board, and a monitor of robots."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from class_router import Answering
from robots import Stage, assert_fails, ready, until
from statuses import READY

from beatrix_zenoh import Monitor, Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.client import Presence
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Fault, Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage

PATIENCE_S = 10.0


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.node("bea")
        yield made


@pytest.fixture
def robot(stage: Stage) -> Iterator[Robot]:
    """The robot at home and ready."""
    robot = stage.robot("bea", "hw")
    robot.stop()
    robot.disable()
    yield ready(robot)
    robot.stop()
    robot.client.close()


def resident_kb() -> int:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4


@pytest.mark.long("thousands of queries")
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
@pytest.mark.no_cover
def test_queries_free_their_memory(stage: Stage) -> None:
    """Zenoh keeps 0.8 kB for each query until its timeout: a program that runs for 24 hours must not leak."""
    robot = Robot("bea", "hw", client=stage.client(), timeout_s=0.5)

    def ask(count: int) -> int:
        before = resident_kb()
        for _ in range(count):
            robot.status()
        return resident_kb() - before

    ask(3000)  # fills the memory that earlier tests have freed
    # Once as many queries are freed as are sent, memory no longer grows. A busy computer delays that.
    until(lambda: ask(1500) < 600, "memory is reused: if none were freed, 1500 queries would need 1200 kB")


def test_make_ready_enables_and_calibrates_as_far_as_needed(robot: Robot) -> None:
    robot.disable()
    robot.make_ready()
    status = robot.status()
    assert (status.enabled, status.calibrated) == (True, True)
    robot.make_ready()
    assert robot.status().calibrations == status.calibrations
    robot.look(yaw=2)


def test_make_ready_never_clears_the_emergency_latch(robot: Robot) -> None:
    robot.emergency_stop()
    assert_fails(robot.make_ready, Refused, Reason.EMERGENCY, r"latched.*beatrix reset")
    assert robot.status().fault is Fault.EMERGENCY
    robot.reset()
    assert not robot.status().enabled


def test_a_closed_robot_raises_wrong_usage_and_its_streams_end(stage: Stage) -> None:
    robot = stage.robot("bea", "hw")
    stream, status, events = robot.stream(), robot.status_stream(), robot.events()
    robot.client.close()
    uses: list[Callable[[], object]] = [robot.status, robot.stop, robot.stream, robot.events]
    uses += [robot.client.bus.robots, lambda: Monitor(robot.client), lambda: robot.look(yaw=1)]
    uses += [lambda: publish_stop(robot.client, robot.place)]
    for use in uses:
        with pytest.raises(WrongUsage, match="closed by this program"):
            use()
    for subscription in (stream, status, events):
        list(subscription)  # ends, after what had arrived before the client was closed
        with pytest.raises(NoAnswer, match="was closed by this program"):
            subscription.next(0)
    robot.client.close()


def test_the_error_of_a_motion_of_a_closed_client_is_shutdown(stage: Stage) -> None:
    robot = stage.robot("bea", "hw")
    robot.stop()  # the session that sends STOP need not pause
    motion = ready(robot).look(yaw=90, speed=20, wait=False)
    robot.client.close()
    assert_fails(motion.wait, NoAnswer, Reason.SHUTDOWN, "This program closed its connection")
    watcher = stage.robot("bea", "hw")
    until(lambda: not watcher.status().holder, "free again")


def test_a_monitor_wakes_on_changes_and_shows_arrivals_and_losses_of_robots(
    stage: Stage, robot: Robot
) -> None:
    with Monitor(stage.client(), "toy", events=5) as monitor, zbus.connect(stage.endpoint) as bus:
        assert monitor.robots() == []
        end = bus.declare_token(keys.alive("toy", "hw"))
        assert monitor.wait(PATIENCE_S)
        assert monitor.present() == [("toy", "hw")]
        assert monitor.robot("toy", "hw").presence is Presence.SILENT
        bus.put(keys.status("toy", "hw"), codec.encode(READY), codec.MSGPACK)
        assert monitor.wait(PATIENCE_S)
        assert monitor.robot("toy", "hw").status == READY
        event = Event(seq=3, t_mono_ns=1, t_wall_ns=2, kind=EventKind.LEASE)
        bus.put(keys.events("toy", "hw"), codec.encode(event), codec.MSGPACK)
        assert monitor.wait(PATIENCE_S)
        assert monitor.robot("toy", "hw").events == (event,)
        assert not monitor.wait(0.0)
        end()
        assert monitor.wait(PATIENCE_S)
        assert monitor.robot("toy", "hw").presence is Presence.ABSENT
        assert monitor.present() == []


@pytest.mark.parametrize(
    ("connected", "reason"), [((), Reason.ACCESS_DENIED), ((False, True), Reason.NO_ROUTER)]
)
def test_a_request_without_reply_just_after_the_return_of_the_router_is_not_called_refused(
    stage: Stage, connected: tuple[bool, ...], reason: Reason
) -> None:
    """As in a class whose routers do not know all of the robot's keys yet."""
    account = Account("8b", "ana", "student", "", dt.date.max, "", "", "")
    with zbus.connect(stage.endpoint) as bus, stage.client() as client:
        bus.declare_token(keys.alive("toy", "hw"))
        Answering(bus, keys.clock("toy", "hw"))
        client.settings = replace(client.settings, account=account)
        for there in connected:
            client._on_router(there)
        assert_fails(Robot("toy", "hw", client=client).status, NoAnswer, reason)
