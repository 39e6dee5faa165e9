"""The client layer with a node on the virtual board, and with fake nodes."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest
from robots import Stage, ready, until
from statuses import READY

from beatrix_zenoh import Interrupted, Monitor, Motion, Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.client import Presence
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Command,
    CommandQuery,
    CommandReply,
    Detail,
    Event,
    EventKind,
    Fault,
    Limit,
    Reason,
    Status,
    Vector3,
)
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


class FakeNode:
    """A node with fixed replies that records the commands it gets."""

    def __init__(
        self, endpoint: str, name: str, status: Status, replies: dict[Command, CommandReply]
    ) -> None:
        self.commands: list[CommandQuery] = []
        self._name, self._replies = name, replies
        self.bus = zbus.connect(endpoint)
        self.bus.serve(keys.status(name, "hw"), lambda incoming: self._answer(incoming, status))
        self.bus.serve(keys.command(name, "hw", "*"), self._command)
        self.bus.declare_token(keys.alive(name, "hw"))

    @staticmethod
    def _answer(incoming: Incoming, message: msgspec.Struct) -> None:
        incoming.reply(incoming.key, codec.encode(message), codec.MSGPACK)
        incoming.finish()

    def _command(self, incoming: Incoming) -> None:
        query = codec.decode(incoming.raw.payload, CommandQuery)
        self.commands.append(query)
        self._answer(incoming, self._replies.get(Command(query.command), command_reply(Reason.OK)))


def command_reply(reason: Reason, detail: Detail | None = None) -> CommandReply:
    origin = Vector3(0.0, 0.0, 0.0)
    return CommandReply(
        result=reason is Reason.OK, reason=reason, message=f"It is {reason}.", position=origin, detail=detail
    )


def fake_node(stage: Stage, status: Status, **replies: CommandReply) -> tuple[Robot, FakeNode]:
    node = FakeNode(stage.endpoint, "toy", status, {Command[name]: reply for name, reply in replies.items()})
    return stage.robot("toy", "hw"), node


# -- motions ------------------------------------------------------------------------------------


def test_a_motion_is_a_future(robot: Robot) -> None:
    motion = robot.look(yaw=4, wait=False)
    called: queue.SimpleQueue[Motion] = queue.SimpleQueue()
    motion.add_done_callback(called.put)
    assert motion.running()
    with pytest.raises(TimeoutError):
        motion.result(0.001)
    assert motion.result().result
    assert called.get(timeout=PATIENCE_S) is motion
    assert (motion.done(), motion.exception(), motion.cancel()) == (True, None, False)


def test_cancel_stops_the_robot(robot: Robot) -> None:
    motion = robot.look(yaw=100, speed=20, wait=False)
    ends: queue.SimpleQueue[object] = queue.SimpleQueue()
    motion.add_done_callback(lambda ended: ends.put(ended.exception()))
    assert motion.cancel()
    end = ends.get(timeout=PATIENCE_S)
    assert isinstance(end, Interrupted)
    assert end.reason is Reason.STOPPED
    assert not robot.status().moving


def test_the_session_that_sent_stop_may_move_at_once(robot: Robot) -> None:
    """STOP is sent as a publication and as a query; the robot identifies the session of both."""
    for yaw in (5, -5, 5):
        robot.look(yaw=yaw, speed=20, wait=False)
        robot.stop()
        robot.look(yaw=0)


def test_the_timeout_of_a_query_follows_from_the_longest_possible_motion(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, float] = {}
    query = robot.client.bus.query

    def record(
        key: str,
        payload: bytes | None,
        encoding: str,
        priority: str | None,
        timeout_s: float,
        attachment: bytes | None,
    ) -> zbus.Query:
        asked[key.rpartition("/")[2]] = timeout_s
        return query(key, payload, encoding, priority, timeout_s, attachment)

    monkeypatch.setattr(robot.client.bus, "query", record)
    robot.look(yaw=1)
    robot.move(1, 1, 1, speed=(80, 80, 40))
    assert 144 < asked["pose"] < 160  # 720 deg at 5 deg/s, the lowest speed limit of a teacher
    assert 18 < asked["motion"] < 30
    robot.look(yaw=1.2, speed=0.5)
    assert 1440 < asked["pose"] < 1500
    robot.status()
    assert asked["status"] < 20


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


# -- getting ready ------------------------------------------------------------------------------


def test_make_ready_enables_and_calibrates_as_far_as_needed(robot: Robot) -> None:
    robot.disable()
    robot.make_ready()
    status = robot.status()
    assert (status.enabled, status.calibrated) == (True, True)
    robot.make_ready()
    assert robot.status().calibrations == status.calibrations
    robot.look(yaw=2)


def test_make_ready_never_clears_the_emergency_latch(stage: Stage) -> None:
    latched = msgspec.structs.replace(READY, enabled=False, calibrated=False, fault=Fault.EMERGENCY)
    robot, node = fake_node(stage, latched)
    with node.bus:
        with pytest.raises(Refused, match=r"latched.*beatrix reset") as caught:
            robot.make_ready()
        assert (caught.value.reason, node.commands) == (Reason.EMERGENCY, [])
        robot.reset()
        assert [query.command for query in node.commands] == [Command.RESET]


def test_the_error_of_a_refused_command_contains_the_detail(stage: Stage) -> None:
    detail = Detail(limit=Limit.HOME, value=1.5, high=0.5, alternative=Alternative())
    robot, node = fake_node(stage, READY, CALIBRATE=command_reply(Reason.HOME_KNOWN, detail))
    with node.bus:
        with pytest.raises(Refused) as caught:
            robot.calibrate()
        assert caught.value.detail == detail


# -- wrong arguments, closed clients ------------------------------------------------------------


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
    with pytest.raises(NoAnswer, match="This program closed its connection") as caught:
        motion.wait()
    assert caught.value.reason is Reason.SHUTDOWN
    watcher = stage.robot("bea", "hw")
    until(lambda: not watcher.status().holder, "free again")


# -- subscriptions ------------------------------------------------------------------------------


def test_a_stream_is_in_degrees_and_can_be_iterated_and_closed(robot: Robot) -> None:
    robot.look(yaw=12)
    with robot.stream() as stream:
        for reading in stream:
            if reading.head.yaw == pytest.approx(12, abs=0.3):
                break
        latest = stream.latest
        assert latest is not None
        assert latest.t >= reading.t
        arrival = stream.next_arrival()
        assert (arrival.robot, arrival.side) == ("bea", "hw")
    with pytest.raises(NoAnswer, match="closed"):
        stream.next()


# -- monitor and clocks -------------------------------------------------------------------------


def test_a_monitor_shows_every_robot(stage: Stage, robot: Robot) -> None:
    with Monitor(stage.client()) as monitor:
        monitor.settle()
        state = monitor.robot("bea", "hw")
        assert state.status is not None
        assert (state.presence is not Presence.ABSENT, state.status.calibrated) == (True, True)
        robot.look(yaw=8)

        def fresh() -> bool:
            state = monitor.robot("bea", "hw")
            return state.hz > 45 and state.positions_age_s is not None and state.positions_age_s < 0.1

        until(fresh, "positions come at 50 Hz")
        state = monitor.robot("bea", "hw")
        reading = state.reading
        assert reading is not None
        assert state.presence is Presence.ONLINE
        assert reading.head.yaw == pytest.approx(8, abs=0.3)
        assert monitor.robot("none", "sim").presence is Presence.ABSENT
        assert [(one.robot, one.side) for one in monitor.robots()] == [("bea", "hw")]


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
