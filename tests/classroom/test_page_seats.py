"""Pages of a class: each browser gets the seat of its word, its account and its robot, and nothing else."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import partial
from typing import Any

import pytest
from class_router import CLI, ClassRouter
from robots import EVENT_S, Process, until
from tornado.websocket import WebSocketClosedError
from web_client import WebClient, WebSocket

from beatrix_zenoh import Robot
from beatrix_zenoh import class_words as words
from beatrix_zenoh.client import lesson_reports
from gui.page import hub
from gui.page.seats import WRONG_MAX, Seats
from gui.page.sockets import MALFORMED


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class whose seats ana and ben, and the robot bea1, are simulated."""
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        options = ("--seats", str(made.class_file), "--name", "bea1", "--ready")
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("BEATRIX_ACCOUNT", str(made.path("teacher")))
            simulation = Process(*CLI, "sim", *options)
        for _ in range(3):
            simulation.expect("ready")
        yield made
        simulation.end()


def drives(view: dict[str, Any]) -> bool:
    return any("yours" in pill["notes"] for pill in view["pills"])


def ready(browser: WebClient) -> WebSocket:
    """Return a page that drives its own robot, which needs no press."""
    page = browser.connect()
    page.state(drives, "the page drives its own robot")
    return page


def looks(yaw: float, view: dict[str, Any]) -> bool:
    return abs(view["head"]["sim"]["yaw"] - yaw) < 0.5  # type: ignore[no-any-return]


def look(page: WebSocket, yaw: float) -> None:
    page.send("AimHead", yaw=yaw, pitch=0, roll=0)
    page.send("SendHead")


def stops(robot: Robot) -> dict[str, int]:
    """Return the number of STOPs by seat."""
    return {one.seat: one.count for one in robot.status().stops}


def test_each_page_drives_its_own_head_under_its_own_seat(
    browsers: dict[str, WebClient], router: ClassRouter
) -> None:
    ana, ben = ready(browsers["ana"]), ready(browsers["ben"])
    assert (ana.view["robots"], ben.view["robots"]) == (["ana", "bea1"], ["ben", "bea1"])
    look(ana, 20.0)
    look(ben, -10.0)
    for page, yaw in ((ana, 20.0), (ben, -10.0)):
        page.state(partial(looks, yaw), "the head has turned")
    assert ana.view["you"]["beside"] == "bea1"
    assert {pose[0] for pose in ana.poses} == {0, 2}, (
        "of the own head, and of the simulation of the robot beside it"
    )
    with router.robot("ana", "sim", "teacher") as robot:
        assert robot.status().holder == "ana"


def button(view: dict[str, Any]) -> str:
    """Return what the button *Follow* asks for."""
    return view["gestures"]["programs"][0][2]["intent"]["do"]  # type: ignore[no-any-return]


def test_the_head_of_a_seat_follows_with_its_account_until_the_page_ends_that(
    browsers: dict[str, WebClient], router: ClassRouter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub, "DEAD_MAN_S", EVENT_S)  # this page beats only when a view arrives
    ana = ready(browsers["ana"])
    with router.robot("ana", "sim", "teacher") as robot:
        robot.move_target(1.0, -0.4, 0.1)
        for end in ("EndProgram", "hidden"):
            ana.send("RunExample", program="follow")
            ana.state(lambda view: button(view) == "EndProgram" and view["eyes"]["follows"], "it has begun")
            ana.state(lambda view: view["head"]["sim"]["yaw"] < -12.0, "the head turns to the person")
            ana.send(end)
            ana.state(lambda view: button(view) == "RunExample", f"it has ended by {end}")
        assert robot.status().holder == "ana"


def test_a_sequence_becomes_a_gesture_of_the_seat_which_plays_and_deletes_it(
    browsers: dict[str, WebClient], router: ClassRouter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub, "DEAD_MAN_S", EVENT_S)  # this page beats only when a view arrives
    ana, file = ready(browsers["ana"]), router.folder / "programs/ana/gestures/wink.csv"
    ana.send("AimHead", yaw=25.0, pitch=0.0, roll=0.0)
    ana.send("AddPose", name="left")
    ana.send("SetDuration", name="left", seconds=2.0)
    ana.send("SaveGesture", name="wink", emoji="😎")

    def there(view: dict[str, Any]) -> bool:
        return any(one[:2] == ["wink", "😎"] for one in view["gestures"]["gestures"])

    ana.state(there, "it has a button")
    assert file.is_file()
    ana.send("Play", row=0, sides=[], poses=[], again=[], lead_s=0.0, gesture="wink")
    ana.state(lambda view: view["head"]["sim"]["yaw"] > 22.0, "the head plays it")
    assert not any(one[0] == "wink" for one in ready(browsers["ben"]).view["gestures"]["gestures"])
    ((name, button),) = ana.view["gestures"]["deletes"]
    ana.send(**button["intent"])
    ana.state(lambda view: not there(view), "its button is gone")
    assert (name, file.is_file()) == ("wink", False)


def test_a_page_cannot_show_or_drive_the_head_of_another_seat(browsers: dict[str, WebClient]) -> None:
    ben = ready(browsers["ben"])
    for name in ("ana", "teacher", "*", "bea2"):
        ben.send("ChooseRobot", name=name)
    look(ben, 5.0)
    ben.state(lambda view: "done" in view["last"], "the motion of its own head has ended")
    assert ben.view["robot"] == "ben"
    pictures = browsers["ben"].connect("/pictures?robot=ana&side=sim")
    until(lambda: pictures.read() is None, "no pictures of another seat's eyes")


def test_a_lesson_is_judged_kept_and_reported_for_the_seat_of_its_page(
    browsers: dict[str, WebClient], router: ClassRouter
) -> None:
    ana = ready(browsers["ana"])
    ana.send("check_program", lesson="b6-edge", program=PROGRAM)
    result = ana.state(lambda view: bool(view["check"]["result"]), "the verdict")["check"]["result"]
    assert (router.folder / "progress/ana/progress.json").is_file()
    with router.robot("bea1", "sim", "teacher") as robot:
        (row,) = lesson_reports.read(robot.client)
    progress = {"not_yet": "trying", "not_measurable": "not-measured"}  # on a computer that is busy
    assert (row.seat, row.lesson, row.progress) == ("ana", "b6-edge", progress[result])


def test_only_the_teachers_page_governs(browsers: dict[str, WebClient], router: ClassRouter) -> None:
    ben, teacher = ready(browsers["ben"]), browsers["teacher"].connect()
    freeze = {"row": -1, "action": "freeze", "places": [["ben", "sim"]]}
    ben.send("class", on=True)
    ben.send("Govern", **freeze)
    ben.send("LimitClass", text="5")
    look(ben, 8.0)
    ben.state(lambda view: "done" in view["last"], "nothing is frozen")
    assert ben.view["govern"] is None
    with router.robot("ben", "sim", "teacher") as robot:
        assert not robot.status().speed_limit
        teacher.state(
            lambda view: bool(view.get("govern")), "the teacher's buttons, at once", heartbeat=False
        )
        teacher.send("Govern", **freeze)
        until(lambda: robot.status().frozen, "the teacher's page freezes")
        ben.state(lambda view: view["pills"][0]["condition"] == "frozen", "the page says so")
        teacher.send("Govern", **{**freeze, "action": "unfreeze"})
        until(lambda: not robot.status().frozen, "and unfreezes")


PROGRAM = json.dumps({
    "blocks": {"blocks": [{"type": "start", "next": {"block": {"type": "home"}}}]}
})  # fmt: skip
TOO_LARGE = 1009
"""With this code of the protocol, or without reading so far, Tornado closes a web socket after too large a message."""
OTHERS: list[dict[str, Any]] = [
    *(
        {"do": "ChooseRobot", "name": name}
        for name in ("ana", "teacher", "*", "**", "ana/sim", "bea2", "@router")
    ),
    *({"do": "drive", "name": name} for name in ("ana", "teacher")),
    *(
        {"do": "open_program", "name": "secret", "seat": seat}
        for seat in ("ana", "../ana", "teacher", "ana/versions")
    ),
    *({"do": "open_program", "name": name} for name in ("../ana/secret", "/etc/passwd", "..", "secret.json")),
    *(
        {"do": "save_program", "name": name, "program": PROGRAM}
        for name in ("../ana/secret", "../../words", "a/b", "..", "", "x" * 100, "C:secret", "secret\0")
    ),
    {"do": "save_program", "name": "huge", "program": "x" * 70_000},
    *({"do": "SaveGesture", "name": name, "emoji": "😎"} for name in ("../ana/wink", "..", "a/b", "x" * 100)),
    {"do": "DeleteGesture", "name": "../../ana/gestures/wink"},
    {"do": "check_program", "lesson": "../../seats/ana", "program": PROGRAM},
    {"do": "hint", "lesson": "../../seats/ana"},
    {"do": "Govern", "row": -1, "action": "mute", "seat": "ana"},
    {"do": "Govern", "row": -1, "action": "take", "places": [["ana", "sim"]]},
    {"do": "LimitClass", "text": "1"},
    {"do": "AskLease", "action": "take", "side": "sim"},
    {"do": "RunBlocks", "program": "[" * 60_000},
    {"do": "RunBlocks", "program": json.dumps({"blocks": {"blocks": [{"type": "start"}] * 10_000}})},
]
"""What a page of another seat may try at ana's head, programs, lessons and word."""


def test_the_teachers_stick_overrides_a_pupil_and_gives_the_robot_back(
    browsers: dict[str, WebClient],
) -> None:
    ana, teacher = ready(browsers["ana"]), browsers["teacher"].connect()
    teacher.send("ChooseRobot", name="ana")
    look(ana, 0.0)
    ana.state(partial(looks, 0.0), "at home")

    def steered(view: dict[str, Any]) -> bool:
        teacher.send("Steer", yaw=0.5, pitch=0.0, roll=0.0)
        return view["head"]["sim"] is not None and view["head"]["sim"]["yaw"] > 5.0

    teacher.state(steered, "the teacher turns the head of the pupil")
    teacher.send("ReleaseArm")
    teacher.state(lambda view: bool(view["you"]["notice"]), "the robot is given back", heartbeat=False)
    assert not teacher.view["you"]["drives"]

    def back(view: dict[str, Any]) -> bool:
        look(ana, 0.0)
        return looks(0.0, view)

    ana.state(back, "the pupil drives on")


def test_a_pupils_stick_needs_a_page_that_drives(browsers: dict[str, WebClient]) -> None:
    ben = ready(browsers["ben"])
    ben.send("ChooseRobot", name="bea1")
    ben.send("Steer", yaw=1.0, pitch=0.0, roll=0.0)
    ben.state(lambda view: bool(view["you"]["notice"]), "the page says that it only watches")
    assert not ben.view["you"]["drives"]


def chose(speed: float, view: dict[str, Any]) -> bool:
    return view["choices"]["speed"] == speed  # type: ignore[no-any-return]


def test_no_message_of_another_page_reaches_a_seat(
    browsers: dict[str, WebClient], router: ClassRouter
) -> None:
    ana = ready(browsers["ana"])
    ana.send("save_program", name="secret", program=PROGRAM)
    ana.state(lambda view: "secret" in view["programs"]["names"], "ana's program is kept")
    before = {
        path: path.read_bytes()
        for path in router.folder.rglob("*")
        if path.is_file() and "ben" not in str(path)
    }
    ben = ready(browsers["ben"])
    seen = []
    for number, message in enumerate(OTHERS):
        ana.send("beat")
        ben.send(**message)
        try:
            ben.send("Choose", name="speed", value=10 + number)
            view = ben.state(partial(chose, 10 + number), str(message)[:80])
        except (AssertionError, WebSocketClosedError):
            until(lambda page=ben: page.read() is None, "closed")  # type: ignore[misc]
            assert ben.code in (MALFORMED, TOO_LARGE, None), message
            ben = ready(browsers["ben"])
        else:
            seen.append((view["robot"], json.dumps(view["programs"])))
    assert {robot for robot, _ in seen} == {"ben"}
    assert not any('"seat": "ana"' in programs for _, programs in seen)
    after = {
        path: path.read_bytes()
        for path in router.folder.rglob("*")
        if path.is_file() and "ben" not in str(path)
    }
    assert after == before
    with router.robot("ana", "sim", "teacher") as robot:
        assert (robot.status().holder, robot.status().muted, robot.status().speed_limit) == ("ana", [], 0.0)


def test_stop_of_a_page_has_its_seat(browsers: dict[str, WebClient], router: ClassRouter) -> None:
    ben = ready(browsers["ben"])
    with router.robot("bea1", "sim", "teacher") as robot:
        ben.send("ChooseRobot", name="bea1")
        ben.state(lambda view: view["robot"] == "bea1", "it watches the robot of the class")
        ben.send("stop", robot="bea1", stop="n1")  # a page that does not drive
        until(lambda: stops(robot).get("ben") == 1, "the STOP is ben's")
        reply = browsers["ben"].fetch("/stop", '{"do":"stop","robot":"bea1","stop":"n2"}')
        assert reply.code == 200
        until(lambda: stops(robot).get("ben") == 2, "also that of a page whose web socket is broken")
        assert "teacher" not in stops(robot)


def test_the_newest_page_of_a_seat_drives(browsers: dict[str, WebClient]) -> None:
    first = ready(browsers["ben"])
    second = ready(browsers["ben"])  # a page that was loaded again, or another tablet
    first.state(lambda view: "Another page of your seat" in view["you"]["notice"], "the first one says why")
    assert not first.view["you"]["drives"]
    look(second, 6.0)
    second.state(partial(looks, 6.0), "the second one drives")


def test_a_word_that_was_replaced_ends_its_pages(browsers: dict[str, WebClient], router: ClassRouter) -> None:
    ana, old = ready(browsers["ana"]), words.read(router.folder).words["ana"]
    words.renew(router.folder, "ana")
    until(lambda: ana.read() is None, "the page is closed")
    assert browsers["ana"].refusal()[0] == 403
    assert browsers["ana"].log_in(old).code == 403
    assert browsers["ana"].log_in(words.read(router.folder).words["ana"]).code == 303


@pytest.mark.parametrize("typed", ["", "ana", "ana:", "../teacher", "x" * 5000, "<b>", "ana:abcdef"])
def test_what_is_no_word_opens_no_page(browsers: dict[str, WebClient], typed: str) -> None:
    stranger = browsers[""]
    assert stranger.log_in(typed).code in (400, 403)
    stranger.cookies |= {name: f"ana:{typed}" for name in stranger.cookies if name.startswith("beatrix")}
    assert stranger.refusal()[0] == 403
    assert "page.js" not in stranger.fetch("/").body.decode()
    assert stranger.fetch("/stop", '{"do":"stop","robot":"ana","stop":"x"}').code == 403


def test_a_room_behind_one_address_may_mistype(router: ClassRouter) -> None:
    seats, right = Seats(router.classroom, router.folder), words.read(router.folder).words["ben"]
    for number in range(WRONG_MAX):
        assert seats.enter(right.upper() + " ", "nat", number / 10).ticket, (
            "capitals and spaces do not matter"
        )
        assert seats.enter("wrong", "nat", number / 10).refusal == "page.wrong_word"
    assert seats.enter(right, "nat", 6.0).refusal == "page.wait"
    assert seats.enter(right, "nat", 61.0).ticket
    assert seats.enter(right, "other", 6.0).ticket
