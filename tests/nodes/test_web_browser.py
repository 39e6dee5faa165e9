"""The control page in a real browser: buttons and keys move and stop a robot."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Browser
from robots import Stage, until
from web_client import PIN, serving

from beatrix_zenoh import Robot
from gui.page import server


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.hardware("bea1")
        yield made


@pytest.fixture(scope="module")
def robot(stage: Stage) -> Robot:
    return stage.robot("bea1", "hw")


@pytest.fixture
def serving_page(monkeypatch: pytest.MonkeyPatch) -> Iterator[contextlib.ExitStack]:
    """A stack that ends the server of the page when it closes."""
    monkeypatch.setattr(server, "ALL", server.LOOPBACK)  # tests stay on loopback
    with contextlib.ExitStack() as ending:
        yield ending


@pytest.fixture
def browser(stage: Stage, serving_page: contextlib.ExitStack, tmp_path: Path) -> Iterator[Browser]:
    """A browser that has opened the page with the PIN, with the screen size of a phone."""
    port = serving_page.enter_context(serving(stage.endpoint, pin=PIN))
    with Browser(tmp_path, (360, 640)) as made:
        made.open(f"http://127.0.0.1:{port}/")
        made.run("document.querySelector('#pin').focus()")
        made.type(PIN)
        made.click("button")
        made.wait(lambda: made.text("#state") == "Motors off", "the page")
        yield made


def far(robot: Robot, angle: float) -> bool:
    return robot.positions().head.yaw > angle


def test_a_student_drives_from_a_browser(
    browser: Browser, robot: Robot, serving_page: contextlib.ExitStack
) -> None:
    browser.click("#yaw-plus")
    browser.wait(lambda: "press Drive first" in browser.text("#head .refusal"), "a refusal beside the button")
    browser.run("document.querySelector('#name').value = 'Mia K.'")
    browser.click("#drive")
    browser.wait(lambda: browser.text("#driver") == "You drive as web-mia-k.", "drives")
    browser.click("[data-command=ready]")
    browser.wait(lambda: browser.text("#state") == "Ready", "ready")

    browser.press("#yaw-plus")
    until(lambda: far(robot, 3.0), "a held button moves the head")
    browser.release("#yaw-plus")
    browser.wait(lambda: browser.text("#state") == "Ready", "the robot rests")
    yaw = robot.positions().head.yaw
    browser.wait(lambda: browser.text("#value-yaw") == f"{yaw:.1f}°", "the angle is shown")

    browser.press("#yaw-plus")
    until(lambda: far(robot, yaw + 3.0), "moves again")
    browser.key(" ")
    browser.wait(lambda: "bea1 (hw)" in browser.text("#stopped"), "STOP by the keyboard")
    browser.release("#yaw-plus")
    assert not robot.status().moving

    robot.emergency_stop()
    browser.wait(lambda: browser.text("#state") == "Emergency stop", "the emergency is shown")
    browser.click("[data-command=reset]")
    browser.wait(lambda: browser.text("#state") == "Motors off", "reset")

    stop = "(({bottom, width, height}) => [bottom, width, height])(document.querySelector('#stop').getBoundingClientRect())"
    for width, height in ((360, 640), (1366, 768)):
        browser.resize(width, height)
        assert browser.run("document.documentElement.scrollWidth <= innerWidth"), "nothing is cut off"
        box = browser.run(stop)
        assert box[0] == height
        assert box[1] >= width - 20
        assert box[2] >= 72
    browser.run("document.querySelector('#looking').click()")
    loaded = "[...document.images].filter((image) => image.naturalWidth > 0 && image.offsetWidth > 0).length"
    browser.wait(lambda: browser.run(loaded) == 2, "both eyes")
    assert browser.errors() == []

    serving_page.close()
    browser.wait(lambda: browser.text("#state") == "Server lost", "the server has ended")
    assert "beatrix stop" in browser.text("#trouble")
    browser.click("#stop")
    assert "STOP did not reach the server." in browser.text("#stopped")
