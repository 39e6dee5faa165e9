"""Requests of the teacher's window to all robots, of which one does not answer."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from class_router import ClassRouter, replies
from gui_links import Linked
from gui_views import lesson
from present import present
from robots import Stage

from beatrix_zenoh.client import RobotState, own_gestures
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction, Reason
from gui.console.state.actions import FetchGestures, Govern, SendStop, ShareGesture, Watch
from gui.console.state.intents import TogglePage
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, World


@pytest.mark.long("waits for robots that do not answer")
def test_a_robot_that_does_not_answer_is_named_and_the_others_are_frozen() -> None:
    with Stage() as stage:
        stage.node("bea2")
        hung = stage.hardware("bea")
        with Linked(stage.endpoint, who="teacher") as linked:
            linked.do(Watch(class_page=True))
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
            linked.do(Watch())
            assert linked.world.robots == ()


def test_freeze_limit_and_stop_reach_all_robots() -> None:
    with Stage() as stage:
        for name in ("bea1", "bea2"):
            stage.node(name)
        with Linked(stage.endpoint, who="teacher") as linked:
            linked.do(Watch(class_page=True))
            linked.until(lambda world: len(world.robots) == 2, "all robots are listed")
            linked.do(Govern(1, LeaseAction.FREEZE))
            linked.do(Govern(2, LeaseAction.LIMIT, speed=0.5))
            linked.do(SendStop(3, everywhere=True))
            for row in (1, 2, 3):
                end = linked.end_of(row)
                assert (end.accepted, end.robots) == (True, 2)
            linked.until(lambda world: all(map(is_frozen_and_slow, world.robots)), "both obey")


def is_frozen_and_slow(robot: RobotState) -> bool:
    return robot.status is not None and robot.status.frozen and robot.status.speed_limit > 0


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """The router of a class, with a pupil whose name is known."""
    with ClassRouter(tmp_path_factory.mktemp("class"), seats='{ana = "Ána Ruiz"}') as router:
        yield router


@pytest.fixture
def teacher(school: ClassRouter) -> Iterator[Linked]:
    account = school.account("teacher")
    with Linked(account.connect, "bea1", "teacher", account=account) as linked:
        yield linked


def test_the_window_of_a_class_mutes_the_seat_of_a_named_pupil(school: ClassRouter, teacher: Linked) -> None:
    ana = school.session("ana")
    ana.declare_token(keys.seat("ana", ana.session_id))
    teacher.do(Watch(class_page=True))
    teacher.until(lambda world: world.seats == ("ana", "teacher"), "the seats are listed")
    assert teacher.world.shown("ana") == "Ána Ruiz (ana)"
    (seat,) = page_seats(teacher.world)
    teacher.do(Govern(1, LeaseAction.MUTE, seat=seat))
    assert teacher.end_of(1).accepted
    assert replies(school.session("teacher"), keys.pending("bea2", "hw")), "bea2 gets it later"


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
def test_the_reports_of_the_class_are_read_while_its_page_is_shown(
    school: ClassRouter, teacher: Linked
) -> None:
    ana = school.session("ana")
    teacher.until(lambda world: world.phase is LinkPhase.ONLINE, "a session")
    assert teacher.world.reports is None
    teacher.do(Watch(class_page=True))
    for report in (lesson("ana", "01-hello", stuck=5), lesson("ana", "01-hello", passed=True, tries=6)):
        ana.put(keys.lesson("ana", "01-hello"), codec.encode(report.state), codec.MSGPACK)
        teacher.until(lambda world, report=report: world.reports == (report,), "the report is read")  # type: ignore[misc]
    teacher.do(Watch())
    assert teacher.world.reports is None


def test_only_the_teacher_reads_reports(school: ClassRouter) -> None:
    account = school.account("ana")
    with Linked(account.connect, "bea1", "ana", account=account) as linked:
        linked.do(Watch(class_page=True))
        assert linked.until(lambda world: world.reports_failed, "refused").reports is None


def test_a_gesture_goes_from_a_pupil_to_the_teacher_and_to_all(
    school: ClassRouter, teacher: Linked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def sit(seat: str) -> Path:
        monkeypatch.setenv("HOME", str(tmp_path / seat))
        return own_gestures.folder()

    text = "# emoji: 😜\nt_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n0,10,0,0,30\n"
    sit("ana").mkdir(parents=True)
    (own_gestures.folder() / "wink.csv").write_text(text, encoding="utf-8")
    account = school.account("ana")
    with Linked(account.connect, "bea1", "ana", account=account) as ana:
        ana.until(lambda world: world.phase is LinkPhase.ONLINE, "a session")
        ana.do(ShareGesture("wink", 1))
        assert ana.end_of(1).accepted
        folder = sit("teacher")
        teacher.do(FetchGestures(1))
        assert teacher.end_of(1).accepted
        assert (folder / "ana-wink.csv").read_text(encoding="utf-8") == text
        sit("ana")
        ana.do(FetchGestures(2))
        assert ana.end_of(2).key == "result.none_shared"
        sit("teacher")
        teacher.do(ShareGesture("ana-wink", 2))
        assert teacher.end_of(2).accepted
        sit("ana")
        ana.do(FetchGestures(3))
        assert ana.end_of(3).accepted
        ana.until(lambda world: [one.name for one in world.gestures] == ["ana-wink", "wink"], "it is there")
