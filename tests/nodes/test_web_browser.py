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

pytestmark = pytest.mark.long("a real browser")


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.hardware("bea1")
        made.simulation("bea1")
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
    """A browser that has opened the page with the PIN, with the screen size of a phone; the motors are off."""
    for side in ("sim", "hw"):
        stage.robot("bea1", side).emergency_stop()  # ends the lease of a page before, too
        stage.robot("bea1", side).reset()
    port = serving_page.enter_context(serving(stage.endpoint, pin=PIN))
    with Browser(tmp_path, (360, 640)) as made:
        made.open(f"http://127.0.0.1:{port}/")
        made.run("document.querySelector('#typed').focus()")
        made.type(PIN)
        made.click("button")
        made.wait(lambda: "motors off" in made.text("#pills"), "the page")
        yield made


def yaw(robot: Robot) -> float:
    return robot.positions().head.yaw


def slide(browser: Browser, **angles: float) -> None:
    """Move sliders; a slider to the right is positive."""
    for part, angle in angles.items():
        slider = f"document.querySelector('#aim-{part}')"
        browser.run(f"{slider}.value = {angle}, {slider}.dispatchEvent(new Event('input'))")


def choose_lead(browser: Browser, seconds: int) -> None:
    lead = "document.querySelector('#lead')"
    browser.run(f"{lead}.value = {seconds}, {lead}.dispatchEvent(new Event('change'))")


def drag_face(browser: Browser, way: float) -> None:
    """Drag the face to the right of the picture (px)."""
    browser.run("scrollTo(0, 0)")
    x, y = browser.run(
        "(({x, y, width, height}) => [x + width / 2, y + height * 0.4])(document.querySelector('#marks').getBoundingClientRect())"
    )
    for kind, at in (("mousePressed", x), ("mouseMoved", x + way), ("mouseReleased", x + way)):
        browser.mouse(kind, at, y)


def edge(browser: Browser, selector: str, name: str) -> float:
    """Return the place of an edge of an element on the screen (px)."""
    place: float = browser.run(f"document.querySelector('{selector}').getBoundingClientRect().{name}")
    return place


def drive(browser: Browser) -> None:
    """Take both robots and make them ready."""
    browser.click("#yaw-plus")
    browser.wait(lambda: "press Drive first" in browser.text("#notice"), "only watches")
    browser.run("document.querySelector('#name').value = 'Mia K.'")
    browser.click("#drive")
    browser.wait(lambda: "yours" in browser.text("#pills > :last-child"), "drives")
    assert browser.text("#you") == "You drive as web-mia-k."
    browser.click("#hw")
    for pill, step in (("first", "Make ready"), ("last", "Enable"), ("last", "Calibrate")):
        button = f"#pills > :{pill}-child button"
        browser.wait(lambda button=button, step=step: browser.text(button) == step, step)  # type: ignore[misc]
        browser.click(button)
        if step == "Make ready":  # then this pill needs less room, and the button of the other one moves
            browser.wait(lambda: "Simulation: ready" in browser.text("#pills"), "the simulation is ready")
    browser.wait(lambda: browser.text("#pills").count("ready") == 2, "both are ready")


def test_a_student_drives_from_a_browser(
    browser: Browser, robot: Robot, stage: Stage, serving_page: contextlib.ExitStack
) -> None:
    drive(browser)
    browser.press("#yaw-plus")
    until(lambda: yaw(robot) > 3.0, "a held button moves both heads")
    browser.key(" ")
    browser.wait(lambda: browser.text("#last").startswith("last: stop done"), "STOP by the keyboard")
    browser.release("#yaw-plus")
    assert not robot.status().moving

    rests = yaw(robot)
    choose_lead(browser, 5)
    slide(browser, yaw=20)
    browser.click("#send")
    browser.wait(lambda: "hardware follows in" in browser.text("#countdown"), "the simulation leads")
    until(lambda: yaw(stage.robot("bea1", "sim")) < 0.0, "the simulation goes first")
    assert yaw(robot) == pytest.approx(rests, abs=0.5)
    browser.click("#send_now")
    until(lambda: yaw(robot) < -15.0, "the hardware follows at once")

    browser.wait(lambda: browser.text("#last").startswith("last: look right 20 done"), "both rest")
    choose_lead(browser, 0)
    browser.resize(360, 740)
    browser.click("#send_on_release")
    browser.wait(lambda: browser.run("document.querySelector('#send_on_release').checked"), "chosen")
    drag_face(browser, 60)
    until(lambda: yaw(robot) > 0.0, "a drag is sent when it ends")
    browser.click("#gestures button")
    until(lambda: robot.positions().head.pitch > 3.0, "a gesture nods")

    for size in ((360, 640), (820, 1180), (1366, 768)):
        check_size(browser, *size)
    browser.click("#sim")
    browser.run("document.querySelector('#looking').click()")
    loaded = "[...document.images].filter((image) => image.naturalWidth > 0 && image.offsetWidth > 0).length"
    browser.wait(lambda: browser.run(loaded) == 2, "both eyes")
    assert browser.errors() == []

    serving_page.close()
    browser.wait(lambda: "beatrix stop" in browser.text("#trouble"), "the server has ended")
    browser.click("#stop")
    assert "STOP did not reach the server." in browser.text("#last")


def test_a_refusal_and_its_alternative_in_german(browser: Browser, robot: Robot) -> None:
    drive(browser)
    browser.run("document.querySelector('#language').value = 'de'")
    browser.run("document.querySelector('#language').dispatchEvent(new Event('change'))")
    browser.wait(lambda: browser.text("#drive") == "Zurückgeben", "German")
    browser.resize(360, 740)
    slide(browser, pitch=30, roll=30)
    browser.run(f"window.scrollBy(0, {edge(browser, '#send', 'bottom') - edge(browser, '#stop', 'top')})")
    browser.run("document.querySelector('#send').click()")  # where it is, just above STOP
    browser.wait(lambda: "35,0°" in browser.text("#refusal-head p"), "a refusal beside the sliders")
    assert browser.text("#refusal-head .alternative").startswith("Blick auf ")
    assert edge(browser, "#refusal-head .alternative", "bottom") <= edge(browser, "#stop", "top")
    browser.click("#refusal-head .alternative")
    until(lambda: robot.positions().head.pitch > 10.0, "the alternative is accepted")
    assert browser.run("document.querySelector('#refusal-head').hidden")
    browser.wait(lambda: browser.text("#history li:first-child").startswith("✓ Blick"), "in the history")

    browser.click("#emergency")
    browser.wait(lambda: "Halte den Kopf" in browser.text("#question"), "asks first")
    assert robot.status().enabled
    browser.click("#emergency")
    browser.wait(lambda: "Notstopp" in browser.text("#banner"), "shown")
    assert not robot.status().enabled
    assert browser.errors() == []


def check_size(browser: Browser, width: int, height: int) -> None:
    """Nothing is cut off, and STOP is at the bottom, large."""
    browser.resize(width, height)
    assert browser.run("document.documentElement.scrollWidth <= innerWidth")
    box = browser.run(
        "(({bottom, width, height}) => [bottom, width, height])(document.querySelector('#stop').getBoundingClientRect())"
    )
    assert box[0] == height
    assert box[1] >= width - 160
    assert box[2] >= 72
