"""STOP and EMERGENCY_STOP while programs go on sending requests."""

from __future__ import annotations

import pytest
import zenoh
from bodies import EVERY, Body
from late_tests import within
from robots import turning, until

from beatrix_zenoh import Interrupted, Robot
from beatrix_zenoh.bus import Query
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Command, CommandQuery, Event, EventKind

pytestmark = pytest.mark.bodies(*EVERY, safety=True)


@pytest.mark.measures_time
def test_stop_is_answered_within_half_a_second(robot: Robot) -> None:
    motion = turning(robot)
    with within(0.5, "STOP, with 0.2 s to decelerate"):
        robot.stop()
    with pytest.raises(Interrupted):
        motion.wait()


def test_a_stop_just_after_the_beginning_of_a_motion_says_that_it_stopped_it(robot: Robot) -> None:
    for yaw in (30, -30, 30):
        motion = robot.look(yaw=yaw, wait=False)
        assert robot.stop().message.startswith("Stopped")
        with pytest.raises(Interrupted):
            motion.wait()
    assert robot.stop().message.startswith("Nothing moves")


def test_a_stop_is_one_event_of_the_seat_that_pressed_it(body: Body, robot: Robot) -> None:
    boss = body.robot("boss")
    with robot.events(timeout_s=20.0) as events:
        began_ns = robot.positions().t * 1e9  # STOPs of the previous test may still arrive
        boss.stop()
        received: list[Event] = []

        def receive(timeout_s: float) -> bool:
            stops = [event for event in events.take(timeout_s) if event.kind is EventKind.STOP]
            received.extend(event for event in stops if event.t_mono_ns > began_ns)
            return bool(received)

        until(lambda: receive(0.1), "the event")
        robot.status()
        receive(0.3)
    assert [(event.action, event.seat, event.count) for event in received] == [("STOP", "boss", 1)]


@pytest.mark.bodies("in-process")
@pytest.mark.parametrize(
    ("key", "seat"), [("stop", ""), ("stop/cem", "cem"), ("cmd/cem/command?command=stop", "cem")]
)
def test_a_stop_with_the_session_of_another_seat_is_not_recorded_under_that_seat(
    body: Body, robot: Robot, key: str, seat: str
) -> None:
    """The source info of a message can be forged; the seat in its key is checked by the router of a class."""
    ben, cem = body.robot("ben"), body.robot("cem")
    gid = ben.client.bus.use(lambda session: session.id)
    with robot.events(timeout_s=20.0) as events:
        forged = f"beatrix/{robot.name}/{robot.side}/{key}"
        cem.client.bus.use(
            lambda session: session.get(forged, lambda _: None, source_info=zenoh.SourceInfo(gid, 1))
        )
        event = next(event for event in events if event.kind is EventKind.STOP)
    assert (event.seat, event.session) == (seat, ben.client.bus.session_id)


def test_stop_is_carried_out_before_waiting_commands(body: Body, robot: Robot) -> None:
    """Each command waits for telemetry, so all of them take most of a second; STOP must not wait for them."""
    boss = body.robot("boss")
    key = keys.command(robot.name, robot.side, "ana")
    enable = codec.encode(CommandQuery(command=Command.ENABLE.value))
    queries = [robot.client.bus.query(key, enable, codec.MSGPACK, "interactive_high") for _ in range(60)]
    boss.stop()
    waiting = sum(map(unanswered, queries))
    for query in queries:
        query.close()
    assert waiting > 10


def unanswered(query: Query) -> bool:
    """Return whether no reply has arrived."""
    try:
        query.next(0)
    except TimeoutError:
        return True
    return False
