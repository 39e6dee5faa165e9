"""Several clients of one robot: lease, STOP, lost clients, floods."""

from __future__ import annotations

import threading

import pytest
from bodies import Body
from floods import Flood
from robots import ask_raw, assert_fails, turning, until

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import CommandReply, Positions, Reason
from beatrix_zenoh.motion.gear import Gear
from beatrix_zenoh.node.pauses import QUIET_S

pytestmark = pytest.mark.bodies("in-process")  # the node alone decides about access
FLOOD_S = 40.0
"""Time limit (s) of events that a flood delays on a busy machine."""


def test_a_second_client_is_refused_with_the_holders_name_and_the_motion_continues(
    body: Body, robot: Robot
) -> None:
    other = body.robot("ben")
    motion = robot.look(yaw=8, speed=10, wait=False)
    assert_fails(lambda: other.look(yaw=-20), Refused, Reason.NOT_HOLDER, "ana drives")
    for request in (other.disable, other.calibrate, other.home):
        with pytest.raises(Refused) as refusal:
            request()
        assert refusal.value.reason in (Reason.NOT_HOLDER, Reason.NOT_AT_REST)
    motion.wait()
    assert robot.positions().commanded.short == pytest.approx(8, abs=0.1)


@pytest.mark.parametrize(
    "form", ["{}/stop", "{}/stop/ben", "{}/stop/Ben!", "beatrix/*/*/stop", "beatrix/**/stop/ben"]
)
def test_a_put_on_a_stop_key_stops_the_robot(robot: Robot, form: str) -> None:
    motion = turning(robot)
    robot.client.bus.put(form.format(f"beatrix/{robot.name}/{robot.side}"), b"", "text/plain", "real_time")
    assert_fails(motion.wait, Interrupted, Reason.STOPPED)


@pytest.mark.parametrize("form", ["{}/stop", "{}/stop/ben", "beatrix/*/*/stop/ben", "beatrix/**/stop/ben"])
def test_a_query_on_a_stop_key_is_answered_on_the_key_of_its_seat(robot: Robot, form: str) -> None:
    own = f"beatrix/{robot.name}/{robot.side}"
    (answer,) = ask_raw(robot.client, form.format(own))
    assert answer.key == f"{own}/stop" + "/ben" * form.endswith("ben")
    assert codec.decode_json(answer.payload, CommandReply).result


@pytest.mark.parametrize(("seat", "command"), [("legacy", "STOP"), ("Ana", "EMERGENCY_STOP"), ("*", "STOP")])
def test_stop_is_accepted_from_an_invalid_seat(robot: Robot, seat: str, command: str) -> None:
    motion = robot.look(yaw=60, wait=False)
    key = f"beatrix/{robot.name}/{robot.side}/cmd/{seat}/command"
    (answer,) = ask_raw(robot.client, f"{key}?command={command}")
    assert not answer.error
    assert codec.decode_json(answer.payload, CommandReply).result
    with pytest.raises(Interrupted):
        motion.wait()


def test_a_query_or_put_on_all_keys_does_not_stop_the_robot(robot: Robot) -> None:
    motion = robot.look(yaw=6, wait=False)
    ask_raw(robot.client, "beatrix/**")
    robot.client.bus.put("beatrix/**", b"hello", "text/plain")
    for key in ("beatrix/*/*/*/*", "beatrix/*/*/arm/*/target", "beatrix/bea/*/arm/**"):
        robot.client.bus.put(key, b"hello", "text/plain")
    motion.wait()


def test_emergency_stop_is_carried_out_during_a_flood_of_stops(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    over = threading.Event()

    def press() -> None:
        while not over.is_set():
            publish_stop(robot.client, robot.place)

    thread = threading.Thread(target=press)
    thread.start()
    try:
        other.emergency_stop()
        assert not other.status().enabled
    finally:
        over.set()
        thread.join()


def test_the_motion_of_a_client_that_disconnects_is_stopped(body: Body, robot: Robot) -> None:
    leaver = body.robot("leaver")
    until(lambda: robot.status().holder == "", "lease over")
    leaver.look(yaw=60, wait=False)
    until(lambda: robot.positions().commanded.short > 2, "moving")
    leaver.client.close()
    until(lambda: not robot.status().moving, "stopped")
    assert robot.positions().commanded.short < 50
    assert robot.status().holder == ""


@pytest.mark.bodies("sim", "in-process", safety=True)
def test_the_robot_stays_stopped_while_another_client_floods_it(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    stream = other.positions_stream()
    with Flood(robot) as flood:
        until(
            lambda: flood.sent > 300 and other.positions().commanded.short > 3, "flooded and moving", FLOOD_S
        )
        reply = other.stop()
        flooded = flood.sent
        rested_s = other.positions().t  # earlier publications may still arrive
        after: list[Positions] = []

        def received_enough() -> bool:
            other.stop()  # repeated STOPs must not end the pause of the flooding seat
            after.extend(positions for positions in stream.take(0.1) if positions.t_mono_ns > rested_s * 1e9)
            return len(after) > 60 and flood.sent > flooded + 300

        until(received_enough, "the flood continues and nothing moves", FLOOD_S)
    assert "rest at" in reply.message
    assert {positions.commanded for positions in after} == {reply.position}
    counts = {(positions.steps.x, positions.steps.y, positions.steps.z) for positions in after}
    assert counts == {Gear().to_steps((reply.position.x, reply.position.y, reply.position.z))}


def test_a_stopped_seat_must_pause_before_it_moves_again(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    turning(robot, 40)
    other.stop()
    rest = robot.positions().commanded
    assert_fails(lambda: robot.look(yaw=40), Refused, Reason.STOPPED, "STOP")
    assert robot.positions().commanded == rest

    def moves_again() -> bool:
        try:
            robot.look(yaw=0, speed=60, wait=False)
        except Refused:
            return False
        return True

    assert not moves_again(), "each request restarts the pause"
    threading.Event().wait(QUIET_S)  # there is no event at the end of a pause
    assert moves_again()
