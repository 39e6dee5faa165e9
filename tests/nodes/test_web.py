"""The control page: one driver at a time, heartbeats, STOP, pictures. Real server, robots and router."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from robots import Stage, ready, until
from web_client import WebClient, WebSocket, serving

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Source
from gui.page.handlers import MESSAGES_MAX

NAMES, PRESSES = itertools.count(1), itertools.count(1)


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


def resting(state: dict[str, Any]) -> bool:
    """Return whether a state shows that no motion is running."""
    return not state["robot"]["status"]["moving"]


def hold_button(
    page: WebSocket, part: str, holds: Callable[[dict[str, Any]], bool], what: str
) -> dict[str, Any]:
    """Hold a button until a message fulfils `holds`, with a heartbeat for each state; return the message."""
    press = next(PRESSES)

    def held(message: dict[str, Any]) -> bool:
        nonlocal press
        if "heartbeat" in message.get("text", "") or "rest" in message.get("text", ""):
            press = next(PRESSES)  # this computer was too busy for a heartbeat: press again
        page.send("hold", press=press, part=part, sign=1, speed=20)
        return holds(message)

    found = page.wait(held, what)
    page.send("release", press=press)
    return found


def jog(page: WebSocket, part: str, moved: float) -> None:
    """Hold the + button of an axis until its absolute angle is above `moved` (deg)."""
    index = ("yaw", "pitch", "roll").index(part)
    hold_button(
        page,
        part,
        lambda message: message["kind"] == "state" and abs(message["robot"]["head"][index]) > moved,
        "moved",
    )


def slowly_home(page: WebSocket) -> None:
    """Begin a motion that takes longer than the test."""
    page.send("home", speed=2)
    page.state(lambda state: not resting(state), "moves")


# -- driving -------------------------------------------------------------------------------------------


def test_a_held_button_moves_the_robot_until_it_is_released(driver: WebSocket, robot: Robot) -> None:
    jog(driver, "yaw", 5.0)
    driver.state(resting, "at rest")
    rests = robot.positions().head.yaw
    assert {event.source for event in robot.past_events() if event.pose_query is not None} == {Source.PAGE}
    late = next(PRESSES) - 1
    driver.send("hold", press=late, part="yaw", sign=1, speed=20)  # a late heartbeat
    driver.send("command", command="ready")
    driver.outcome("ready")
    assert robot.positions().head.yaw == pytest.approx(rests, abs=0.2)


def test_a_jog_ends_at_the_limit_with_a_refusal(driver: WebSocket, robot: Robot) -> None:
    refused = hold_button(driver, "pitch", lambda message: message.get("control") == "pitch", "a refusal")
    assert "at most 35.0° is allowed" in refused["text"]
    driver.state(resting, "at rest")
    assert robot.positions().head.pitch == pytest.approx(34.5, abs=1.0)


def test_without_heartbeats_the_robot_stops(driver: WebSocket, robot: Robot) -> None:
    jog(driver, "yaw", 3.0)
    slowly_home(driver)
    assert (
        "No heartbeat"
        in driver.wait(lambda message: "heartbeat" in message.get("text", ""), "stopped", heartbeat=False)[
            "text"
        ]
    )
    driver.wait(lambda message: message["kind"] == "state" and resting(message), "at rest", heartbeat=False)
    assert abs(robot.positions().head.yaw) > 1.0


def test_a_web_socket_that_closes_stops_the_robot_and_gives_it_back(driver: WebSocket, robot: Robot) -> None:
    jog(driver, "yaw", 3.0)
    slowly_home(driver)
    driver.close()
    until(lambda: not robot.status().moving and not robot.status().holder, "stopped, and free")
    assert abs(robot.positions().head.yaw) > 1.0


def test_a_hidden_page_stops_the_robot(driver: WebSocket, robot: Robot) -> None:
    jog(driver, "yaw", 3.0)
    slowly_home(driver)
    driver.send("hidden")
    driver.state(resting, "at rest")
    assert abs(robot.positions().head.yaw) > 1.0


def test_one_page_drives_and_the_next_gets_the_robot_when_it_leaves(
    driver: WebSocket, browser: WebClient
) -> None:
    other = browser.connect()
    seen = other.state(
        lambda state: state["robot"] and state["robot"]["status"]["holder"], "the driver is shown"
    )
    assert seen["robot"]["status"]["holder"].startswith("web-mia")
    other.send("home", speed=40)
    assert other.outcome("home")["text"] == "You only watch this robot: press Drive first."
    other.send("drive", name="ben")
    other.state(lambda state: state["robot"]["status"]["waiting"] == ["web-ben"], "waits")
    driver.send("leave")
    other.state(lambda state: state["you"]["drives"], "drives")
    other.close()


def test_a_name_drives_from_one_page_only(driver: WebSocket, browser: WebClient) -> None:
    holder = driver.seen[-1]["you"]["seat"]
    other = browser.connect()
    other.state(lambda state: state["robot"] is not None, "a robot")
    other.send("drive", name=holder.removeprefix("web-"))
    assert f"Another page drives bea1 as {holder}" in other.outcome("drive")["text"]
    other.close()


def test_each_page_with_a_name_without_latin_letters_has_a_guest_seat_of_its_own(
    port: int, browser: WebClient, robot: Robot
) -> None:
    robot.emergency_stop()  # frees the robot at once
    with WebClient(port) as second:
        second.load()
        pages = [browser.connect(), browser.connect(), second.connect()]
        for page, name in zip(pages, ("美玲", "小明", "🙂"), strict=True):
            page.state(lambda state: state["robot"] is not None, "a robot")
            page.send("drive", name=name)
            page.state(lambda state: state["you"]["drives"] or state["you"]["waits"], f"{name} is a seat")
        seats = [page.seen[-1]["you"]["seat"] for page in pages]
        assert len({*seats}) == len(pages)
        assert all(re.fullmatch(r"web-guest-[0-9-]+", seat) for seat in seats)
        until(lambda: [robot.status().holder, *robot.status().waiting] == seats, "one drives, two wait")
        for page in pages:
            page.close()


def test_the_teacher_takes_the_robot_from_a_page(driver: WebSocket, stage: Stage) -> None:
    with stage.robot("bea1", "hw", "teacher").lease():
        assert "handed over to teacher" in driver.outcome("drive")["text"]
        driver.state(lambda state: not state["you"]["drives"], "watches")


def test_two_browsers_drive_two_robots(driver: WebSocket, browser: WebClient, stage: Stage) -> None:
    other = browser.connect()
    other.state(lambda state: len(state["robots"]) == 2, "both robots")
    other.send("watch", robot="bea2", side="hw")
    other.state(lambda state: state["robot"]["robot"] == "bea2", "the second robot")
    other.drive("cleo")
    other.send("command", command="ready")
    assert other.outcome("ready")["ok"]
    jog(other, "yaw", 2.0)
    assert stage.robot("bea1", "hw").status().holder.startswith("web-mia")
    other.close()


def test_a_page_cannot_watch_an_unknown_robot(browser: WebClient) -> None:
    page = browser.connect()
    page.send("watch", robot="bea9", side="sim")
    assert "There is no robot bea9" in page.outcome("robot")["text"]


def test_only_the_named_robot_is_offered(stage: Stage, robot: Robot) -> None:
    with serving(stage.endpoint, only="bea2") as port, WebClient(port) as browser:
        browser.load()
        state = browser.connect().state(lambda state: state["robot"] is not None, "a robot")
    assert state["robots"] == [{"robot": "bea2", "side": "hw"}]


def test_pages_show_that_a_robot_or_the_router_is_lost() -> None:
    with Stage() as stage:
        stage.node("bea1")
        with serving(stage.endpoint) as port, WebClient(port) as browser:
            browser.load()
            page = browser.connect()
            page.state(lambda state: state["robot"] and state["robot"]["presence"] == "online", "online")
            stage.end_nodes()
            page.state(lambda state: state["robot"]["presence"] == "absent", "absent")
            stage.end_router()
            page.state(lambda state: not state["router"], "no router")


# -- STOP ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", ["web socket", "post"])
def test_every_page_can_stop_the_robot(driver: WebSocket, port: int, robot: Robot, way: str) -> None:
    with WebClient(port) as viewer:
        viewer.load()
        page = viewer.connect()
        jog(driver, "yaw", 3.0)
        slowly_home(driver)
        if way == "post":
            body = json.dumps({"do": "stop", "robot": "bea1", "stop": "7"})
            assert viewer.fetch("/stop", body).code == 200
        else:
            page.send("stop", robot="bea1", stop="7")
        assert page.outcome("stop")["ok"]
    assert not robot.status().moving
    assert abs(robot.positions().head.yaw) > 1.0


def test_stop_of_a_robot_that_is_not_online_tells_what_to_do(browser: WebClient) -> None:
    page = browser.connect()
    page.send("stop", robot="bea9", stop="9")
    outcome = page.outcome("stop")
    assert not outcome["ok"]
    assert "no robot bea9 answered" in outcome["text"]
    assert "switch its motor power off" in outcome["text"]


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
    jog(driver, "yaw", 3.0)
    slowly_home(driver)
    driver.send("stop", robot="bea1", stop="8")
    until(lambda: not robot.status().moving, "stopped")
    assert abs(robot.positions().head.yaw) > 1.0
    jog(driver, "yaw", abs(robot.positions().head.yaw) + 1.0)  # STOP makes only other pages pause


def test_a_page_that_floods_stop_delays_no_stop_of_another_page(
    driver: WebSocket, browser: WebClient, port: int, robot: Robot
) -> None:
    flooding = browser.connect()
    jog(driver, "yaw", 3.0)
    slowly_home(driver)
    for number in range(2 * MESSAGES_MAX):
        flooding.send("stop", robot=f"other{number % 7}", stop=f"flood-{number}")
    with WebClient(port) as viewer:
        viewer.load()
        page = viewer.connect()
        page.send("stop", robot="bea1", stop="7")
        assert page.outcome("stop")["ok"]
    assert not robot.status().moving
    assert abs(robot.positions().head.yaw) > 1.0


def test_cameras_work_only_while_a_page_shows_them(browser: WebClient, robot: Robot) -> None:
    def streaming() -> bool:
        return any(camera.streaming for camera in robot.status().cameras)

    socket = browser.connect("/pictures?robot=bea1&side=hw")
    assert socket.read() is not None
    until(streaming, "the cameras work")
    socket.close()
    until(lambda: not streaming(), "the cameras stop")
