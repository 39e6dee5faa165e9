"""Foreign queryables and publishers, and robots of another version: they do not block access to robots."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import msgspec
import pytest
import zenoh
from robots import Stage, ready, until
from shell import Shell
from statuses import READY
from zenoh.handlers import Callback

from beatrix_zenoh import Interrupted, Robot
from beatrix_zenoh.contract._generated.messages import Reason


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.node("bea")
        yield made


@pytest.fixture
def robot(stage: Stage) -> Iterator[Robot]:
    """The robot, ready, without a holder."""
    robot = stage.robot("bea", "hw")
    robot.stop()
    robot.disable()  # makes `ready` calibrate the robot in the position where the previous test has left it
    yield ready(robot)
    robot.stop()
    robot.client.close()


@contextmanager
def foreign(stage: Stage) -> Iterator[zenoh.Session]:
    """A plain Zenoh session."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([stage.endpoint]))
    with zenoh.open(config) as session:
        yield session


def test_a_plain_get_moves_the_robot_and_keeps_the_last_reply(stage: Stage, robot: Robot) -> None:
    """With the defaults of Zenoh, as in its examples."""
    robot.disable()
    with foreign(stage) as session:

        def get(selector: str, payload: str | None = None) -> dict[str, object]:
            (reply,) = session.get(f"beatrix/bea/hw/{selector}", payload=payload, timeout=8)
            assert reply.ok is not None
            value: dict[str, object] = json.loads(reply.ok.payload.to_string())
            return value

        assert get("cmd/me/pose?yaw=0.2")["reason"] == "NOT_ENABLED"
        assert get("cmd/me/command?command=enable")["result"] is True
        assert get("cmd/me/command", '{"command":2}')["result"] is True
        assert get("cmd/me/pose?yaw=0.1;speed=1")["phase"] == "done"
        assert robot.positions().head.yaw == pytest.approx(math.degrees(0.1), abs=0.5)
        assert get("stop")["result"] is True
    until(lambda: not robot.status().holder, "free")


def answer_all(session: zenoh.Session, key: str, reply_key: str, payload: bytes) -> zenoh.Queryable[None]:
    """Declare a complete queryable, like `z_storage --complete`; without `reply_key` it uses the key of the query."""

    def answer(query: zenoh.Query) -> None:
        with query:
            query.reply(reply_key or query.key_expr, payload)

    return session.declare_queryable(key, Callback(answer, indirect=False), complete=True)


def test_a_foreign_queryable_on_all_keys_blocks_no_query_to_the_robot(
    stage: Stage, robot: Robot, caplog: pytest.LogCaptureFixture
) -> None:
    with foreign(stage) as session:
        queryable = answer_all(session, "beatrix/**", "", b"\x81\xa4mood\xa3sad")
        ready(robot)
        motion = robot.look(yaw=90, speed=20, wait=False)
        until(lambda: robot.status().moving, "moving")
        for _ in range(3):
            assert robot.stop().result
        end = motion.exception(5.0)
        assert isinstance(end, Interrupted)
        assert end.reason is Reason.STOPPED
        warnings = [record for record in caplog.records if "ignored: " in record.getMessage()]
        assert [record.name for record in warnings] == ["beatrix_zenoh.client"]
        assert str(session.zid()) in warnings[0].getMessage()
        queryable.undeclare()


@contextmanager
def robot_of_another_version(stage: Stage) -> Iterator[zenoh.Session]:
    """A robot `odd` online, with undecodable replies and publications."""
    status = msgspec.to_builtins(READY) | {"robot": "odd", "fault": "OVERHEATED", "mood": "sad"}
    odd = "beatrix/odd/hw"
    with foreign(stage) as session:
        token = session.liveliness().declare_token(f"{odd}/@alive")
        answer_all(session, f"{odd}/state/status", f"{odd}/state/status", msgspec.msgpack.encode(status))
        answer_all(
            session, f"{odd}/info", f"{odd}/info", msgspec.msgpack.encode({"robot": "odd", "version": "9.0"})
        )
        answer_all(session, f"{odd}/stop/*", f"{odd}/stop/ana", b"what?")
        over = threading.Event()

        def publish() -> None:
            while not over.wait(0.02):
                session.put(f"{odd}/state/positions", b"here and there")
                session.put(f"{odd}/state/status", msgspec.msgpack.encode(status))
                session.put("beatrix/bea/hw/state/elsewhere", b"?")

        publisher = threading.Thread(target=publish)
        publisher.start()
        try:
            yield session
        finally:
            over.set()
            publisher.join()
            token.undeclare()


def test_a_robot_of_another_version_is_listed_and_hides_no_other(stage: Stage, robot: Robot) -> None:
    shell = Shell(stage.endpoint)
    assert robot.status().calibrated
    with robot_of_another_version(stage):
        done = shell.run("ls", "--json")
        rows = {row["robot"]: row for row in json.loads(done.stdout)["robots"]}
        assert (rows["bea"]["state"], rows["odd"]["answers"]) == ("ready", False)
        assert ": ignored" in done.stderr
        assert "odd (hw): is online but sends no readable status" in shell.good("ls")


def test_an_undecodable_stop_reply_does_not_end_the_stop(stage: Stage, robot: Robot) -> None:
    shell = Shell(stage.endpoint)
    motion = robot.look(yaw=90, speed=20, wait=False)
    with robot_of_another_version(stage):
        done = shell.run("stop", "--json")
        rows = {row["robot"]: row for row in json.loads(done.stdout)["robots"]}
        assert rows["bea"]["result"]
        assert (rows["odd"]["result"], rows["odd"]["reason"]) == (False, "TIMED_OUT")
        assert "beatrix/odd/hw/stop/ana" in done.stderr
        assert isinstance(motion.exception(5.0), Interrupted)


@pytest.mark.parametrize("typed", ["state/postions", "cmd/me/motion/now", "scene/targte"])
def test_a_query_for_a_mistyped_key_gets_an_error_that_names_the_keys(
    stage: Stage, robot: Robot, typed: str
) -> None:
    with foreign(stage) as session:
        for target in (zenoh.QueryTarget.BEST_MATCHING, zenoh.QueryTarget.ALL):
            (reply,) = session.get(f"beatrix/bea/hw/{typed}", target=target, timeout=8)
            assert reply.err is not None
            told = json.loads(reply.err.payload.to_string())
            assert (told["result"], told["reason"]) == (False, "BAD_VALUE")
            assert f"no key 'beatrix/bea/hw/{typed}'" in told["message"]
            assert "beatrix/bea/hw/cmd/<who>/motion" in told["detail"]["known"]
    assert robot.status().calibrated
