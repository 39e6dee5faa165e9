"""Requests of the teacher's window to all robots, of which one does not answer."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from class_router import ClassRouter, replies, start_node
from gui_links import Linked
from gui_views import lesson
from present import present
from robots import Stage

from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction, Reason
from gui.console.state.actions import Govern, SendStop, WatchClass
from gui.console.state.intents import TogglePage
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, World


@pytest.mark.long("waits for robots that do not answer")
def test_a_robot_that_does_not_answer_is_named_and_the_others_are_frozen() -> None:
    with Stage() as stage:
        stage.node("bea2")
        hung = stage.hardware("bea")
        with Linked(stage.endpoint, who="teacher") as linked:
            linked.do(WatchClass(on=True))
            linked.until(lambda world: len(world.robots) == 2, "all robots are listed")
            linked.until(lambda world: world.seats == ("teacher",), "the seat is listed")
            hung.send(signal.SIGSTOP)
            linked.do(Govern(1, LeaseAction.FREEZE))
            linked.until(
                lambda world: any(robot.status and robot.status.frozen for robot in world.robots),
                "the other robot is frozen",
            )
            linked.do(SendStop(2, everywhere=True))
            frozen, stop = linked.end_of(1), linked.end_of(2)
            assert frozen.reason in (Reason.TIMED_OUT, Reason.NODE_LOST), (
                "its session is lost after 2 s, and the time limit is 2 s, too"
            )
            assert stop.reason is Reason.NODE_HANGS, "it publishes no positions"
            assert "power off" in stop.message
            for end in (frozen, stop):
                assert (end.accepted, end.robots, end.failed) == (False, 2, ("bea (hw)",))
            hung.send(signal.SIGCONT)
            linked.do(WatchClass(on=False))
            assert linked.world.robots == ()


def test_the_window_of_a_class_mutes_the_seat_of_a_named_pupil(tmp_path: Path) -> None:
    with ClassRouter(tmp_path, seats='{ana = "Ána Ruiz"}') as router:
        node, teacher = start_node(tmp_path, router.path("bea1")), router.account("teacher")
        try:
            ana = router.session("ana")
            ana.declare_token(keys.seat("ana", ana.session_id))
            with Linked(teacher.connect, "bea1", "teacher", account=teacher) as linked:
                linked.do(WatchClass(on=True))
                linked.until(lambda world: world.seats == ("ana", "teacher"), "the seats are listed")
                linked.until(lambda world: len(world.robots) == 1, "the robot is listed")
                assert linked.world.shown("ana") == "Ána Ruiz (ana)"
                (seat,) = page_seats(linked.world)
                linked.do(Govern(1, LeaseAction.MUTE, seat=seat))
                assert linked.end_of(1).accepted
                assert replies(router.session("teacher"), keys.pending("bea2", "hw")), "bea2 gets it later"
        finally:
            node.end()


def page_seats(now: World) -> list[str]:
    """Return the seats that the buttons of the page mute."""
    state = State()
    state.handle(TogglePage(), now)
    page = present(state.view(now).class_page)
    return [view.mute.intent.seat for view in page.seats if isinstance(view.mute.intent, Govern)]


def test_without_a_robot_requests_to_all_robots_are_refused() -> None:
    with Stage() as stage, Linked(stage.endpoint, who="teacher") as linked:
        linked.do(Govern(1, LeaseAction.FREEZE))
        linked.do(SendStop(2, everywhere=True))
        for row in (1, 2):
            assert not linked.end_of(row).accepted


def test_the_teachers_window_opens_on_a_robot_of_the_class() -> None:
    with Stage() as stage:
        stage.client("ana").bus.declare_token(keys.alive("ana", "sim"))  # the simulation of a seat
        stage.node("bea2")
        stage.node("bea1")
        with Linked(stage.endpoint, "host", who="teacher", name_given=False) as linked:
            linked.until(lambda world: world.robot == "bea1", "the first robot is shown")
            linked.until(lambda world: world.hw.status is not None, "its status is shown")
        with Linked(stage.endpoint, "bea2", who="teacher", name_given=False) as linked:
            linked.until(lambda world: len(world.names) == 3, "all names are online")
            linked.until(lambda world: world.hw.status is not None, "the robot of the settings is shown")
            assert linked.world.robot == "bea2"


@pytest.mark.long("waits for the period of reports")
def test_the_reports_of_the_class_are_read_while_its_page_is_shown(tmp_path: Path) -> None:
    with ClassRouter(tmp_path) as router:
        ana, teacher = router.session("ana"), router.account("teacher")
        report = lesson("ana", "01-hello", stuck=5)
        ana.put(keys.lesson("ana", "01-hello"), codec.encode(report.state), codec.MSGPACK)
        router.settled(ana)
        with Linked(teacher.connect, "bea1", "teacher", account=teacher) as linked:
            linked.until(lambda world: world.phase is LinkPhase.ONLINE, "a session")
            assert linked.world.reports is None
            linked.do(WatchClass(on=True))
            linked.until(lambda world: world.reports == (report,), "the report is read")
            passed = lesson("ana", "01-hello", passed=True, tries=6)
            ana.put(keys.lesson("ana", "01-hello"), codec.encode(passed.state), codec.MSGPACK)
            linked.until(lambda world: world.reports == (passed,), "a later report is read")
            linked.do(WatchClass(on=False))
            assert linked.world.reports is None


def test_only_the_teacher_reads_reports(tmp_path: Path) -> None:
    with ClassRouter(tmp_path) as router:
        account = router.account("ana")
        with Linked(account.connect, "bea1", "ana", account=account) as linked:
            linked.do(WatchClass(on=True))
            assert linked.until(lambda world: world.reports_failed, "refused").reports is None
