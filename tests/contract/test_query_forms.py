"""Forms of a query over a router, wildcards, per-arm topics; tests/unit/test_query_forms.py has all forms and errors."""

from __future__ import annotations

import json
import math

import msgpack
import pytest
from bodies import Body
from robots import ask_raw, until

from beatrix_zenoh import Robot
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction

pytestmark = pytest.mark.bodies("in-process")


def test_msgpack_of_another_library_is_answered_in_msgpack(robot: Robot) -> None:
    query = msgpack.packb({"absolute": True, "position": {"x": 0.02, "y": 0.02, "z": 0.02}})
    answers = ask_raw(robot.client, keys.motion(*robot.place, "ana"), query, codec.MSGPACK)
    assert [msgpack.unpackb(answer.payload)["phase"] for answer in answers] == ["accepted", "done"]


@pytest.mark.bodies("sim", "in-process")
@pytest.mark.parametrize("key", ["{}/{}/cmd/ana/motio$*", "*/*/cmd/ana/motion", "{}/{}/cmd/ana/*"])
def test_a_motion_query_with_wildcards_moves_no_robot(robot: Robot, key: str) -> None:
    selector = f"beatrix/{key.format(robot.name, robot.side)}?x=0.3;y=0.3;z=0.3"
    answers = [json.loads(answer.payload) for answer in ask_raw(robot.client, selector)]
    assert answers
    assert not any(answer["result"] for answer in answers if "tilt_max" not in answer), "no preview"
    own = f"beatrix/{robot.name}/{robot.side}/cmd/"
    assert any(answer["detail"]["known"][0].startswith(own) for answer in answers if answer["detail"])
    assert robot.positions().commanded == (0, 0, 0)


@pytest.mark.parametrize("seat", ["legacy", "arm-topics"])
def test_a_reserved_seat_is_refused_in_one_line_of_json(robot: Robot, seat: str) -> None:
    (answer,) = ask_raw(robot.client, keys.pose(*robot.place, seat) + "?yaw=0.1")
    assert b"\n" not in answer.payload
    reply = json.loads(answer.payload)
    assert (reply["reason"], reply["result"]) == ("BAD_VALUE", False)
    assert "choose another" in str(reply["message"])


def test_each_per_arm_topic_moves_one_arm(body: Body, robot: Robot) -> None:
    bus, teacher = robot.client.bus, body.robot("teacher")
    lease.ask(teacher, LeaseAction.GIVE_BACK)
    for arm, angle in (("short", b"0.05"), ("middle", b"0.1"), ("long", b"-0.05")):
        bus.put(keys.arm_target(robot.name, robot.side, arm), angle, "text/plain")
    wanted = [math.degrees(angle) for angle in (0.05, 0.1, -0.05)]
    until(lambda: robot.positions().commanded == pytest.approx(wanted, abs=0.1), "three arms there")
    lease.ask(teacher, LeaseAction.GIVE_BACK)


def test_a_per_arm_target_with_wildcards_moves_no_arm(robot: Robot) -> None:
    for key in (
        "beatrix/*/*/arm/short/target",
        f"beatrix/{robot.name}/{robot.side}/arm/*/target",
        "beatrix/**/target",
    ):
        robot.client.bus.put(key, b"0.2", "text/plain")
        until(
            lambda: any("wildcards are allowed only for STOP" in line for line in robot.status().warnings),
            "the warning",
        )
    assert robot.positions().commanded == (0, 0, 0)
