"""Decisions of the teacher for robots of the class that are not online: kept by the router, applied when they come."""

from __future__ import annotations

import math
import queue
import signal
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
from class_router import ClassRouter, start_node
from patient_connections import PATIENCE_S, patiently
from robots import until
from shell import beatrix, good

from beatrix_zenoh import Robot
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.classroom.pending import Kept, PendingDecisions, decide, words
from beatrix_zenoh.client import lesson_reports as reports
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction, LeaseQuery
from beatrix_zenoh.lessons.progress import Record

BEA2 = keys.pending("bea2", "hw")
MUTE, UNMUTE = (LeaseQuery(action=action, seat="cem") for action in (LeaseAction.MUTE, LeaseAction.UNMUTE))
LIMIT = LeaseQuery(action=LeaseAction.LIMIT, speed=math.radians(20))


@pytest.mark.parametrize(
    ("decisions", "kept"),
    [
        ([MUTE, LIMIT, UNMUTE], ["limit 20", "unmute cem"]),
        ([MUTE, LeaseQuery(action=LeaseAction.MUTE, seat="ben")], ["mute cem", "mute ben"]),
        ([LeaseQuery(action=LeaseAction.FREEZE), LeaseQuery(action=LeaseAction.UNFREEZE)], ["unfreeze"]),
        ([LeaseQuery(action=LeaseAction.TURN, longest_s=60)], ["limit --turn 60"]),
        ([LIMIT, LeaseQuery(action=LeaseAction.TURN)], ["limit 20", "limit --turn off"]),
        ([LIMIT, LeaseQuery(action=LeaseAction.LIMIT)], ["limit off"]),
    ],
)
def test_of_each_kind_the_newest_decision_is_kept(decisions: list[LeaseQuery], kept: list[str]) -> None:
    found: Kept = {}
    for query in decisions:
        decide(found, BEA2, query, online=False)
    assert [words(query) for query in found[BEA2].values()] == kept


def test_for_a_robot_online_only_what_it_has_not_taken_is_replaced() -> None:
    found: Kept = {}
    decide(found, BEA2, MUTE, online=True)
    assert found == {}, "the teacher's program sends it"
    decide(found, BEA2, MUTE, online=False)
    decide(found, BEA2, LIMIT, online=True)
    decide(found, BEA2, UNMUTE, online=True)
    assert [*found[BEA2].values()] == [UNMUTE], "the mute may be on its way"


def test_a_robot_of_which_one_side_is_online_is_not_listed(tmp_path: Path) -> None:
    found: queue.SimpleQueue[str] = queue.SimpleQueue()
    handlers = SimpleNamespace()
    bus = SimpleNamespace(
        closed=False,
        watch_tokens=lambda _, seen: vars(handlers).update(seen=seen),
        serve=lambda _, asked: vars(handlers).update(asked=asked),
    )
    PendingDecisions(cast("Bus", bus), tmp_path / "pending.json", lambda: ["bea1", "bea2"])
    handlers.seen(keys.alive("bea1", "hw"), alive=True)
    handlers.asked(
        SimpleNamespace(
            key=keys.pending("*", "*"),
            raw=SimpleNamespace(payload=codec.encode(MUTE)),
            reply=lambda key, *_: found.put(key),
            finish=lambda: found.put("end"),
        )
    )
    replies = [*iter(partial(found.get, timeout=PATIENCE_S), "end")]
    bus.closed = True
    handlers.seen("", alive=False)
    assert replies == [keys.pending("bea2", side) for side in ("sim", "hw")]


@pytest.mark.long("restarts a class")
def test_a_robot_that_was_away_gets_the_decisions_of_the_teacher_and_none_of_a_seat(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ClassRouter(tmp_path) as router:
        monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path("teacher")))
        for seat in ("cem", "teacher"):
            wrong = beatrix("mute", seat)
            assert (wrong.returncode, "Its seats are: ana, ben." in wrong.stderr) == (2, True)
        for command in (("mute", "ben"), ("mute", "ana"), ("limit", "20"), ("limit", "--turn", "60")):
            later = "bea1, bea2: not online. The router of the class applies it when the robot comes."
            assert later in patiently(partial(good, *command))
        good("unmute", "ana", "--name", "bea2")

        ana = router.session("ana")
        for key in (BEA2, keys.pending("*", "*")):
            for forged in (None, codec.encode(LeaseQuery(action=LeaseAction.UNMUTE, seat="ben"))):
                sent = ana.query(key, forged, codec.MSGPACK, timeout_s=5.0)
                assert list(sent.replies(5.0)) == [], key
        router.settled(ana)

        def lessons() -> list[reports.Row]:
            with router.client("teacher") as client:
                return reports.read(client)

        report = codec.encode(Record(tries=1).state())
        ana.put(keys.lesson("ana", "01-hello"), report, codec.MSGPACK)
        until(lambda: bool(lessons()), "a report of a lesson")
        router.process.end(signal.SIGKILL)
        router.start_again()
        assert patiently(lessons) == [], "the router forgets the lessons at its end, and no decision"
        line = "bea2 is not online. When it comes, the router of the class applies: "
        assert f"{line}mute ben, limit 20, limit --turn 60, unmute ana" in patiently(
            lambda: good("top", "--once")
        )
        with monkeypatch.context() as of_node:
            of_node.delenv("BEATRIX_ACCOUNT")
            node = start_node(tmp_path, router.path("bea2"))
        try:
            with router.client("teacher") as client:
                robot = Robot("bea2", "hw", client=client, timeout_s=PATIENCE_S)

                def applied() -> bool:
                    status = patiently(robot.status)
                    return (status.muted, round(math.degrees(status.speed_limit))) == (["ben"], 20)

                until(applied, "the robot has the decisions")
            until(lambda: line not in good("top", "--once"), "the router has the robot's replies, too")
            assert "bea1 is not online." in good("top", "--once")
        finally:
            node.end()
