"""The control page: one driver at a time, heartbeats, STOP, pictures. Real server, robots and router."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from block_programs import block, saved
from robots import Stage, ready, until
from web_client import WebClient, WebSocket, online, serving

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Command, Source
from gui.page.sockets import MESSAGES_MAX

NAMES = itertools.count(1)
SPEED_DEG_S = 20.0


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    """Two robots."""
    with Stage() as made:
        made.hardware("bea1")
        made.hardware("bea2")
        yield made


@pytest.fixture(scope="module")
def robot(stage: Stage) -> Robot:
    """The robot that pages show first; tests read its position."""
    return ready(stage.robot("bea1", "hw"))


@pytest.fixture(scope="module")
def port(stage: Stage, robot: Robot) -> Iterator[int]:
    with serving(stage.endpoint) as made:
        yield made


@pytest.fixture
def browser(port: int) -> Iterator[WebClient]:
    """A browser that has loaded the page."""
    with WebClient(port) as made:
        made.load()
        yield made


@pytest.fixture
def driver(browser: WebClient, robot: Robot) -> Iterator[WebSocket]:
    """A page that drives, from home, under a seat that no test has stopped before."""
    robot.emergency_stop()  # ends a motion and its lease at once
    until(lambda: robot.status().holder == "", "the lease of the page before has ended")
    ready(robot)
    page = browser.connect().drive(f"mia{next(NAMES)}")
    yield page
    page.close()


def moving(view: dict[str, Any]) -> bool:
    """Return whether a view shows that a motion is running."""
    return any(pill["condition"] == "moving" for pill in view["pills"])


def resting(view: dict[str, Any]) -> bool:
    """Return whether a view shows a robot at rest."""
    return any(pill["condition"] == "ready" for pill in view["pills"])


def at_limit(view: dict[str, Any]) -> bool:
    """Return whether a view shows a refusal that names the limit of tilt."""
    refusal = view["head"]["refusal"]
    return refusal is not None and "at most 35.0° is allowed" in refusal["text"]


def slowly_home(page: WebSocket, robot: Robot) -> None:
    """Turn the head, and begin a motion home that takes longer than the test."""
    jog(page, "yaw", abs(robot.positions().head.yaw) + 2.0)
    page.send("Choose", name="speed", value=2)
    page.send("RunCommand", command=Command.HOME.value)
    page.state(lambda view: view["history"][0]["what"].startswith("home") and moving(view), "moves")


def stops_on_the_way(robot: Robot) -> None:
    """Wait until the robot rests; it is not at home yet."""
    until(lambda: not robot.status().moving, "at rest")
    assert abs(robot.positions().head.yaw) > 1.0


def hold_button(page: WebSocket, part: str, holds: Callable[[dict[str, Any]], bool], what: str) -> None:
    """Hold a button until a view fulfils `holds`, with a heartbeat for each message."""

    def held(view: dict[str, Any]) -> bool:
        if holds(view):
            return True
        if _says_why(view):
            page.send("ReleaseArm")  # the next heartbeat begins a new press
        page.send("HoldArm", arm=part, sign=1)
        return False

    page.send("Choose", name="speed", value=SPEED_DEG_S)
    page.state(held, what)
    page.send("ReleaseArm")


def _says_why(view: dict[str, Any]) -> bool:
    """Return whether the user reads why a press has ended, for example because no heartbeat arrived in time."""
    rows = view["history"][:1]
    # A limit is shown beside the button.
    stopped = any(row["good"] is False and "allowed" not in row["result"] for row in rows)
    return bool(view["you"]["notice"] or view["head"]["refusal"] or stopped)


def jog(page: WebSocket, part: str, moved: float) -> None:
    """Hold the + button of an axis until its absolute angle is above `moved` (deg)."""
    hold_button(page, part, lambda view: abs(view["head"]["hw"][part]) > moved, "moved")


# -- driving -------------------------------------------------------------------------------------------


def test_a_held_button_moves_the_robot_until_it_is_released(driver: WebSocket, robot: Robot) -> None:
    jog(driver, "yaw", 5.0)
    view = driver.state(lambda view: resting(view) and view["history"][0]["good"] is not None, "at rest")
    assert (view["history"][0]["who"], view["history"][0]["good"]) == ("you", True)
    rests = robot.positions().head.yaw
    assert {event.source for event in robot.past_events() if event.pose_query is not None} == {Source.PAGE}
    driver.send("ReleaseArm")
    assert robot.positions().head.yaw == pytest.approx(rests, abs=0.2)


@pytest.mark.long("jogs to a limit in real time")
def test_a_jog_that_ends_at_the_limit_says_so_at_the_first_press(driver: WebSocket, robot: Robot) -> None:
    hold_button(driver, "pitch", at_limit, "a refusal")
    assert at_limit(driver.state(resting, "at rest"))
    assert robot.positions().head.pitch == pytest.approx(34.5, abs=1.0)


def test_without_heartbeats_the_robot_stops(driver: WebSocket, robot: Robot) -> None:
    slowly_home(driver, robot)
    driver.state(lambda view: "No heartbeat" in view["you"]["notice"], "stopped", heartbeat=False)
    stops_on_the_way(robot)


@pytest.mark.long("waits for the limit of a silent page")
def test_a_silent_page_gives_the_robot_back(driver: WebSocket, robot: Robot) -> None:
    driver.state(lambda view: not view["you"]["drives"], "given back", heartbeat=False)
    assert "silent for too long" in driver.view["you"]["notice"]
    until(lambda: not robot.status().holder, "free")


def test_a_hidden_page_stops_the_robot_and_a_closed_one_gives_it_back(
    driver: WebSocket, robot: Robot
) -> None:
    slowly_home(driver, robot)
    driver.send("hidden")
    stops_on_the_way(robot)
    slowly_home(driver, robot)
    driver.close()
    stops_on_the_way(robot)
    until(lambda: not robot.status().holder, "free")


def test_a_program_of_blocks_ends_with_heartbeats_and_when_the_page_is_hidden(
    driver: WebSocket, robot: Robot
) -> None:
    program = saved(
        block("speed", SPEED=15), block("forever", DO=[block("turn", ANGLE=a) for a in (40, -40)])
    )
    for end in ("beat", "hidden"):
        driver.send("RunBlocks", program=program)
        driver.state(lambda view: view["blocks"]["block"] == "turn-id" and moving(view), "it moves")
        if end == "hidden":
            driver.send("hidden")
        driver.state(lambda view: not view["blocks"]["runs"] and resting(view), "it ends", heartbeat=False)
        driver.send("beat")
    driver.send("RunBlocks", program=" " * (1 << 16) + "{")
    driver.state(lambda view: view["blocks"]["text"].startswith("The program has 65537 bytes"), "refused")


def test_a_page_that_only_watches_runs_no_program(browser: WebClient, robot: Robot) -> None:
    page = browser.connect()
    page.state(online, "a robot")
    page.send("RunBlocks", program=saved(block("turn", ANGLE=40)))
    view = page.state(lambda view: bool(view["you"]["notice"]), "a sentence")
    assert (view["blocks"]["text"], view["blocks"]["runs"]) == ("", False)
    assert not robot.status().moving


def test_one_page_drives_and_the_next_gets_the_robot_when_it_leaves(
    driver: WebSocket, browser: WebClient, robot: Robot
) -> None:
    other = browser.connect()
    other.state(lambda view: "web-mia" in view["pills"][1]["text"], "the driver is shown")
    for request in ({"do": "SendHead"}, {"do": "HoldArm", "arm": "yaw", "sign": 1}):
        other.send_raw(json.dumps(request))
        other.state(lambda view: "press Drive first" in view["you"]["notice"], "only watches")
    other.send("drive", name="ben")
    other.state(lambda view: view["you"]["text"] == "You wait as web-ben.", "waits")
    assert robot.status().waiting == ["web-ben"]
    driver.send("leave")
    other.state(lambda view: "yours" in view["pills"][1]["notes"], "drives")
    assert "It is your turn" in other.state(lambda view: view["banner"], "a banner")["banner"]["text"]
    other.close()


def test_a_name_drives_from_one_page_only(driver: WebSocket, browser: WebClient) -> None:
    holder = driver.view["you"]["seat"]
    other = browser.connect()
    other.state(lambda view: "web-mia" in view["pills"][1]["text"], "a robot")
    other.send("drive", name=holder.removeprefix("web-"))
    other.state(lambda view: f"Another page drives bea1 as {holder}" in view["you"]["notice"], "refused")
    other.close()


def test_the_teacher_takes_the_robot_from_a_page(driver: WebSocket, stage: Stage) -> None:
    with stage.robot("bea1", "hw", "teacher").lease():
        driver.state(lambda view: view["banner"] and "teacher" in view["banner"]["text"], "lost")
        driver.send("RunCommand", command=Command.HOME.value)
        refusal = driver.state(lambda view: view["commands"]["refusal"], "refused")["commands"]["refusal"]
        assert refusal["alternative"]["intent"]["do"] == "AskLease"  # waits for the robot


def test_the_class_is_a_table_of_all_robots_and_a_projector_shows_whose_turn_it_is(
    browser: WebClient, driver: WebSocket
) -> None:
    driver.state(lambda view: view["you"]["drives"], "a page that drives")
    assert "class.js" in browser.fetch("/class").body.decode()
    page = browser.connect()
    view = page.state(online, "a robot")
    assert (view["empty"], view["class"]) == (None, [])
    page.send("class", on=True)
    rows = page.state(lambda view: len(view["class"]) == 2, "both robots")["class"]
    assert [row["cells"][:2] for row in rows] == [["bea1", "Hardware"], ["bea2", "Hardware"]]

    def driven(view: dict[str, Any]) -> bool:
        return any(row["cells"][3].startswith("web-mia") for row in view["class"])

    assert "beatrix stop" in page.state(driven, "the seat that drives")["texts"]["page.stop_hint"]


def test_choices_of_the_browser_return_and_texts_follow_the_language(browser: WebClient) -> None:
    page = browser.connect()
    pose = {"name": "hoch", "short": 1, "middle": 2, "long": 3}
    page.send("open", saved={"language": "de", "speed": 12, "poses": [pose]})
    view = page.state(lambda view: view["language"] == "de", "German")
    assert (view["texts"]["page.drive"], view["pills"][1]["title"]) == ("Steuern", "Hardware")
    assert (view["choices"]["speed"], [card["name"] for card in view["sequence"]["cards"]]) == (12, ["hoch"])
    page.send("Choose", name="language", value="en")
    view = page.state(lambda view: view["saved"]["language"] == "en", "English")
    assert view["saved"]["poses"][0]["name"] == "hoch"


def test_only_the_named_robot_is_offered(stage: Stage, robot: Robot) -> None:
    with serving(stage.endpoint, only="bea2") as port, WebClient(port) as browser:
        browser.load()
        view = browser.connect().state(online, "a robot")
    assert (view["robots"], view["robot"]) == (["bea2"], "bea2")


def test_pages_show_the_first_robot_that_comes_and_that_it_or_the_router_is_lost(alone: Stage) -> None:
    with serving(alone.endpoint) as port, WebClient(port) as browser:
        browser.load()
        page = browser.connect()
        page.state(lambda view: view["robot"] == "bea", "no robot is online")
        alone.node("bea1")
        page.state(lambda view: online(view) and view["robot"] == "bea1", "online")
        alone.end_nodes()
        view = page.state(lambda view: not online(view), "absent")
        assert view["banner"] == {"text": view["banner"]["text"], "buttons": []}  # none that starts a program
        alone.end_router()
        page.state(lambda view: not view["online"], "no router")


# -- STOP ----------------------------------------------------------------------------------------------


def pressed(view: dict[str, Any]) -> dict[str, Any]:
    """Return the newest row of a page's history that is a STOP of its user; one without an outcome if there is none."""
    rows = (row for row in view["history"] if row["who"] == "you" and "stop" in row["what"])
    return next(rows, {"good": None})


@pytest.mark.parametrize("way", ["web socket", "post", "emergency"])
def test_every_page_can_stop_the_robot(driver: WebSocket, port: int, robot: Robot, way: str) -> None:
    with WebClient(port) as viewer:
        viewer.load()
        page = viewer.connect()
        page.state(online, "a robot")
        slowly_home(driver, robot)
        if way == "post":
            body = json.dumps({"do": "stop", "robot": "bea1", "stop": "7"})
            assert viewer.fetch("/stop", body).code == 200
        elif way == "emergency":
            page.send("EmergencyStop")
        else:
            page.send("stop", robot="bea1", stop="7")
        page.state(lambda view: pressed(view)["good"] is not None, "an outcome in its history")
        row = pressed(page.view)
        assert row["good"], row  # although there is no simulation
        stops_on_the_way(robot)
    assert robot.status().enabled is (way != "emergency")


def test_stop_arrives_while_pictures_flood_and_the_page_reads_nothing(
    driver: WebSocket, browser: WebClient, robot: Robot
) -> None:
    pictures = [browser.connect("/pictures?robot=bea1&side=hw") for _ in range(5)]
    for socket in pictures:
        first = socket.read()
        assert isinstance(first, bytes)
        assert (first[0] in (0, 1), first[1:3]) == (True, b"\xff\xd8")
        for number in "01" * 50:  # confirmations of pictures that were not sent
            socket.send_raw(number)
    slowly_home(driver, robot)
    driver.send("stop", robot="bea1", stop="8")
    stops_on_the_way(robot)
    jog(driver, "yaw", abs(robot.positions().head.yaw) + 1.0)  # STOP makes only other pages pause


def test_a_page_that_floods_stop_delays_no_stop_of_another_page(
    driver: WebSocket, browser: WebClient, port: int, robot: Robot
) -> None:
    flooding = browser.connect()
    slowly_home(driver, robot)
    for number in range(2 * MESSAGES_MAX):
        flooding.send("stop", robot=f"other{number % 7}", stop=f"flood-{number}")
    with WebClient(port) as viewer:
        viewer.load()
        page = viewer.connect()
        page.state(online, "a robot")
        page.send("stop", robot="bea1", stop="7")
        stops_on_the_way(robot)


def test_cameras_work_only_while_a_page_shows_them(browser: WebClient, robot: Robot) -> None:
    def streaming() -> bool:
        return any(camera.streaming for camera in robot.status().cameras)

    socket = browser.connect("/pictures?robot=bea1&side=hw")
    assert socket.read() is not None
    until(streaming, "the cameras work")
    socket.close()
    until(lambda: not streaming(), "the cameras stop")
