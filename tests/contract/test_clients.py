"""Several clients at one robot: one drives, the others are told; who goes, stops what he began."""

from __future__ import annotations

import threading
from typing import Self

import pytest
from body import Body
from stage import ask_raw, until

from beatrix_zenoh import Interrupted, Refused, Robot, codec
from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import CommandReply, MotionReply, PoseQuery, Positions, Reason
from beatrix_zenoh.bus import Question
from beatrix_zenoh.drive import Gear
from beatrix_zenoh.errors import WrongUsage


def test_second_client_is_refused_by_name_and_the_first_goes_on(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    motion = robot.look(yaw=8, wait=False)
    with pytest.raises(Refused, match="ana drives") as refusal:
        other.look(yaw=-20)
    assert refusal.value.reason is Reason.NOT_HOLDER
    motion.wait()
    assert robot.positions().commanded.short == pytest.approx(8, abs=0.1)


def test_commands_of_others_are_refused_while_somebody_drives(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    motion = robot.look(yaw=10, wait=False)
    for act in (other.disable, other.calibrate, other.home):
        with pytest.raises(Refused) as refusal:
            act()
        assert refusal.value.reason in (Reason.NOT_HOLDER, Reason.NOT_AT_REST)
    motion.wait()


def test_robot_is_free_two_seconds_after_it_rests(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    robot.look(yaw=2, speed=60)
    until(lambda: robot.status().holder == "", "lease over", 4.0)
    other.look(yaw=0, speed=60)
    assert robot.status().holder == "ben"
    until(lambda: robot.status().holder == "", "lease over", 4.0)


def test_teacher_takes_over(body: Body, robot: Robot) -> None:
    teacher = body.robot("teacher")
    motion = robot.look(yaw=30, wait=False)
    teacher.look(yaw=0, speed=60)
    with pytest.raises(Interrupted) as ended:
        motion.wait()
    assert ended.value.reason is Reason.REPLACED
    until(lambda: robot.status().holder == "", "lease over", 4.0)


def test_anybody_may_stop(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    motion = robot.look(yaw=60, wait=False)
    until(lambda: robot.positions().commanded.short > 1, "moving")
    other.stop()
    with pytest.raises(Interrupted) as ended:
        motion.wait()
    assert ended.value.reason is Reason.STOPPED


def test_a_put_on_the_stop_key_stops(robot: Robot) -> None:
    motion = robot.look(yaw=60, wait=False)
    until(lambda: robot.positions().commanded.short > 1, "moving")
    robot.client.bus.put(keys.stop(robot.name, robot.twin), b"", "text/plain", "real_time")
    with pytest.raises(Interrupted) as ended:
        motion.wait()
    assert ended.value.reason is Reason.STOPPED


@pytest.mark.parametrize("who", ["legacy", "Ana", "*"])
@pytest.mark.parametrize("command", ["STOP", "EMERGENCY_STOP"])
def test_a_stop_is_a_stop_whoever_presses_it(robot: Robot, who: str, command: str) -> None:
    motion = robot.look(yaw=60, wait=False)
    key = f"beatrix/{robot.name}/{robot.twin}/cmd/{who}/command"
    (answer,) = ask_raw(robot.client, key, command.encode(), "text/plain")
    assert not answer.error
    assert codec.decode_json(answer.payload, CommandReply).result
    with pytest.raises(Interrupted):
        motion.wait()


def test_looking_around_with_a_wildcard_does_not_stop(robot: Robot) -> None:
    motion = robot.look(yaw=6, wait=False)
    ask_raw(robot.client, "beatrix/**")
    robot.client.bus.put("beatrix/**", b"hello", "text/plain")
    motion.wait()


def test_emergency_stop_overtakes_a_flood_of_stops(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    over = threading.Event()

    def press() -> None:
        while not over.is_set():
            robot.client.bus.put(keys.stop(robot.name, robot.twin), b"", "text/plain")

    thread = threading.Thread(target=press)
    thread.start()
    try:
        other.emergency_stop()
        assert not other.status().enabled
    finally:
        over.set()
        thread.join()


def test_client_gone_in_mid_move_stops_what_it_began(body: Body, robot: Robot) -> None:
    goner = body.robot("goner")
    until(lambda: robot.status().holder == "", "lease over", 4.0)
    goner.look(yaw=60, wait=False)
    until(lambda: robot.positions().commanded.short > 2, "moving")
    goner.client.close()
    until(lambda: not robot.status().moving, "stopped", 1.5)
    assert robot.positions().commanded.short < 50
    assert robot.status().holder == ""


def test_a_client_whose_seat_goes_is_told_if_it_still_hears(body: Body, robot: Robot) -> None:
    until(lambda: robot.status().holder == "", "lease over", 4.0)
    with zbus.connect(body.stage.endpoint) as bus:
        seat = keys.seat("goner", bus.session_id)
        bus.announce(seat)
        question = bus.question(
            keys.pose(robot.name, robot.twin, "goner"), codec.encode(PoseQuery(yaw=1.0)), codec.MSGPACK
        )
        accepted = question.next(8.0)
        assert accepted is not None
        bus.withdraw(seat)
        done = question.next(8.0)
        question.close()
    assert done is not None
    assert codec.decode(done.payload, MotionReply).reason is Reason.CLIENT_LOST


class Flood:
    """Somebody who sends targets as fast as Zenoh takes them, without reading a reply."""

    def __init__(self, robot: Robot) -> None:
        self.sent = 0
        self._robot = robot
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._questions: list[Question] = []

    def _run(self) -> None:
        bus, key = self._robot.client.bus, keys.pose(self._robot.name, self._robot.twin, "ana")
        while not self._over.is_set():
            query = codec.encode(PoseQuery(yaw=0.7 + 0.05 * (self.sent % 2)))
            self._questions.append(bus.question(key, query, codec.MSGPACK))
            self.sent += 1
            if len(self._questions) > 500:
                self._questions.pop(0).close()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._over.set()
        self._thread.join()
        for question in self._questions:
            question.close()
        self._robot.timeout_s = 10.0
        self._robot.info()  # passes behind what is still on its way


def test_stop_holds_while_another_client_floods(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    stream = other.stream()
    with Flood(robot) as flood:
        until(lambda: flood.sent > 300 and other.positions().commanded.short > 3, "flooded and moving", 15.0)
        reply = other.stop()
        flooded = flood.sent
        rested_s = other.positions().t  # what was published before may still be on its way
        after: list[Positions] = []

        def heard_enough() -> bool:
            other.stop()  # pressed again and again, which must not set the flood free
            after.extend(heard for heard in stream.take(0.1) if heard.t_mono_ns > rested_s * 1e9)
            return len(after) > 60 and flood.sent > flooded + 300

        until(heard_enough, "the flood goes on and nothing moves", 15.0)
    assert "rest at" in reply.message
    assert {positions.commanded for positions in after} == {reply.position}
    counts = {(positions.steps.x, positions.steps.y, positions.steps.z) for positions in after}
    assert counts == {Gear().to_steps((reply.position.x, reply.position.y, reply.position.z))}


def test_command_of_another_client_is_answered_beside_a_flood(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    with Flood(robot) as flood:
        until(lambda: flood.sent > 500 and other.status().holder == "ana", "flooded", 15.0)
        with pytest.raises(Refused, match="ana drives"):
            other.calibrate()


def test_after_a_flood_the_newest_target_wins(robot: Robot) -> None:
    with Flood(robot) as flood:
        until(lambda: flood.sent > 500, "flooded", 15.0)
    robot.timeout_s = 10.0
    robot.look(yaw=5, speed=60)
    assert robot.positions().commanded.short == pytest.approx(5, abs=0.1)


def test_a_stopped_stream_must_pause_before_it_moves_again(body: Body, robot: Robot) -> None:
    other = body.robot("ben")
    robot.look(yaw=40, wait=False)
    until(lambda: robot.positions().commanded.short > 1, "moving")
    other.stop()
    rest = robot.positions().commanded
    with pytest.raises(Refused, match="STOP was pressed") as refusal:
        robot.look(yaw=40)
    assert refusal.value.reason is Reason.STOPPED
    assert robot.positions().commanded == rest

    def moves_again() -> bool:
        try:
            robot.look(yaw=0, speed=60, wait=False)
        except Refused:
            return False
        return True

    assert not moves_again(), "each try begins the pause anew"
    until(lambda: robot.status().holder == "", "two quiet seconds", 4.0)
    assert moves_again()


def test_of_waiting_targets_only_the_newest_runs(robot: Robot) -> None:
    bus, key = robot.client.bus, keys.pose(robot.name, robot.twin, "ana")
    asked = [
        bus.question(key, codec.encode(PoseQuery(yaw=0.02 * number)), codec.MSGPACK) for number in range(1, 9)
    ]
    ends = []
    for question in asked:
        replies = []
        while (answer := question.next(5.0)) is not None:
            replies.append(codec.decode(answer.payload, MotionReply))
        ends.append(replies[-1])
    assert [end.reason for end in ends[:-1]] == [Reason.REPLACED] * 7
    assert ends[-1].result


def test_a_robot_that_was_closed_says_so(robot: Robot) -> None:
    other = Robot(robot.name, robot.twin, connect=robot.client.bus.endpoint, who="ben")
    other.close()
    for ask in (other.status, lambda: other.look(yaw=1), other.stop):
        with pytest.raises(WrongUsage, match="was closed by this program"):
            ask()
