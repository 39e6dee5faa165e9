"""The head on the control page: its poses, its picture in a real browser, drags, and the formulas of its script."""

from __future__ import annotations

import json
import math
import random
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Browser
from PIL import Image
from robots import Stage, ready, until
from web_client import WebClient, serving

from beatrix_zenoh import Robot
from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.scene import Screen, Viewpoint
from beatrix_zenoh.motion.limits.region import reach
from beatrix_zenoh.motion.rotation import rotation_of
from gui.console.state.intents import HeadOrientation
from gui.console.state.sending import border_deg
from gui.page.poses import LAYOUT
from gui.window.widgets.head3d_drag import BEYOND, Drag, Part, picked

FULL = (1366, 768)
SEEN = Viewpoint(zoom=0.2 / 0.172, height=0.066)
"""The distance and the height from which the page shows the head."""


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.simulation("bea1")
        yield made


@pytest.fixture(scope="module")
def robot(stage: Stage) -> Robot:
    return ready(stage.robot("bea1", "sim"))


@pytest.fixture(scope="module")
def port(stage: Stage, robot: Robot) -> Iterator[int]:
    with serving(stage.endpoint) as made:
        yield made


def test_poses_come_often_in_a_motion_and_seldom_at_rest(port: int, robot: Robot) -> None:
    robot.home()
    with WebClient(port) as client:
        client.load()
        page = client.connect()
        page.state(lambda _: len(page.poses) >= 2, "the first poses", heartbeat=False)
        begun, count = time.monotonic(), len(page.poses)
        # Three take 3 s; this process may have seen the pose before them 0.7 s late.
        page.state(lambda _: len(page.poses) >= count + 3, "poses at rest", heartbeat=False)
        assert time.monotonic() - begun > 2.25
        motion = robot.look(yaw=30, wait=False)
        page.state(
            lambda _: LAYOUT.unpack(page.poses[-1])[4] > math.radians(29.9), "arrives", heartbeat=False
        )
        motion.wait()
    assert len({*page.poses}) > 5
    assert len(page.poses[-1]) == LAYOUT.size == 25
    number, *arms, yaw, pitch, roll = LAYOUT.unpack(page.poses[-1])
    found = robot.positions()
    assert number == 0
    assert np.degrees(arms) == pytest.approx((found.arms.short, found.arms.middle, found.arms.long), abs=0.5)
    assert np.degrees((yaw, pitch, roll)) == pytest.approx(found.head, abs=0.5)


def test_the_mesh_is_sent_once(port: int) -> None:
    with WebClient(port) as client:
        first = client.fetch("/head.json")
        again = client.fetch("/head.json", **{"If-None-Match": first.headers["Etag"]})
    assert len(json.loads(first.body)["bodies"]) == 8
    assert (again.code, again.body) == (304, b"")


PADS = """
window.pad = { connected: true, mapping: "standard", axes: [0, 0, 0], buttons: Array.from({ length: 4 }, () => ({ pressed: false })) };
navigator.getGamepads = () => [window.pad];
dispatchEvent(new Event("gamepadconnected"));
"""
"""A gamepad as a browser shows it: Chromium without a screen has none."""


@pytest.mark.long("a real browser")
def test_a_gamepad_turns_the_head_and_stops_it(port: int, robot: Robot, tmp_path: Path) -> None:
    robot.home()
    with Browser(tmp_path / "profile", FULL) as browser:
        browser.open(f"http://127.0.0.1:{port}/")
        browser.wait(partial(shows, browser, "#drive", "Drive"), "the page knows its robot")
        browser.click("#drive")
        browser.wait(lambda: "yours" in browser.text("#pills"), "it drives")
        browser.run(PADS)
        browser.run("window.pad.axes = [0.8, 0, 0]")
        until(lambda: robot.positions().head.yaw > 6, "the right of the stick is the right of the picture")
        browser.run("window.pad.axes = [0, 0, 0]")
        until(lambda: not robot.status().moving, "rests")
        browser.run("window.pad.axes = [-0.8, 0, 0]")
        until(lambda: robot.status().moving, "moves")
        browser.run("window.pad.buttons[1].pressed = true")
        until(lambda: "STOP" in str(browser.run("document.getElementById('last').textContent")), "STOP")
        assert browser.errors() == []
    until(lambda: not robot.status().holder, "free for the next test")


CARDS = "[...document.querySelectorAll('.card')]"


def shows(browser: Browser, selector: str, text: str) -> bool:
    return browser.text(selector) == text


def has_cards(browser: Browser, number: int) -> bool:
    return bool(browser.run(f"{CARDS}.length") == number)


@pytest.mark.long("a real browser")
def test_poses_are_cards_with_pictures_that_can_be_moved(port: int, robot: Robot, tmp_path: Path) -> None:
    with Browser(tmp_path / "profile", FULL) as browser:
        browser.open(f"http://127.0.0.1:{port}/")
        for number, shown in enumerate(("25.0°", "−25.0°"), start=1):
            robot.look(yaw=25 if number == 1 else -25)
            browser.run(f"document.getElementById('pose-name').value = 'pose{number}'")
            browser.wait(partial(shows, browser, "#value-yaw", shown), "there")
            browser.click("#add")
            browser.wait(partial(has_cards, browser, number), "a card for each pose")
        pictures = browser.run(f"new Set({CARDS}.map((card) => card.firstChild.toDataURL())).size")
        assert pictures == 2, "each card shows its own pose"
        browser.run(f"{CARDS}[0].click()")
        browser.click("#later")
        names = f"{CARDS}.map((card) => card.dataset.name).join()"
        browser.wait(lambda: browser.run(names) == "pose2,pose1", "moved")


@pytest.mark.long("two real browsers")
@pytest.mark.parametrize("kind", ["webgl", "2d"])
def test_the_drawn_head_follows_the_robot_and_a_drag(
    port: int, robot: Robot, tmp_path: Path, kind: str
) -> None:
    robot.home()
    with Browser(tmp_path / "profile", FULL) as browser:
        if kind == "webgl":
            browser.pretend_graphics_chip()
        browser.open(f"http://127.0.0.1:{port}/")
        drawn = f"Boolean(document.querySelector('#bodies').getContext('{kind}'))"
        browser.wait(lambda: browser.run("document.querySelector('#bodies').width > 300"), "drawn")
        assert browser.run(drawn), kind
        picture = tmp_path / "page.png"
        browser.wait(lambda: np.isfinite(eyes(browser, picture)[0]), "the eyes are drawn")
        ahead = eyes(browser, picture)
        robot.look(yaw=25, pitch=8)  # to its left: to the right of the picture
        browser.wait(lambda: eyes(browser, picture)[0] > ahead[0] + 20, "the drawn eyes follow the robot")
        robot.home()
        browser.wait(lambda: abs(eyes(browser, picture)[0] - ahead[0]) < 3, "they look ahead again")

        x, y = ahead[0], ahead[1] + 30
        browser.mouse("mousePressed", x, y)
        for way in (20, 40):
            browser.mouse("mouseMoved", x + way, y)
        browser.mouse("mouseReleased", x + way, y)
        browser.wait(lambda: aimed(browser) > 20.0, "the head is turned to its left")
        assert float(browser.run("document.querySelector('#aim-yaw').value")) == pytest.approx(
            -aimed(browser), abs=0.3
        )
        assert browser.errors() == []
    assert robot.positions().head.yaw == pytest.approx(0.0, abs=0.5)  # nothing was sent


def eyes(browser: Browser, file: Path) -> tuple[float, float]:
    """Return the middle of what has the colour of the irises, in the upper part of the picture of the head (px)."""
    browser.picture(file)
    shown = np.asarray(Image.open(file).convert("RGB")).astype(int)
    left, top, width, height = browser.run(
        "(({x, y, width, height}) => [x, y, width, height].map(Math.round))(document.querySelector('#marks').getBoundingClientRect())"
    )
    red, green, blue = np.moveaxis(
        shown[top + 40 : top + height * 2 // 3, left + 80 : left + width - 80], 2, 0
    )
    rows, columns = np.nonzero((green - red > 50) & (blue - red > 50))
    return left + 80 + (columns.mean() if len(columns) > 20 else math.nan), top + 40 + (
        rows.mean() if len(rows) > 20 else math.nan
    )


def aimed(browser: Browser) -> float:
    """Return the yaw of the target that the page shows (deg)."""
    return float(browser.text("#target-yaw").split()[1].rstrip("°").replace("−", "-"))


# -- the formulas of the script are those of Python ---------------------------------------------------


@pytest.mark.long("a real browser")
def test_the_script_computes_what_python_computes(port: int, tmp_path: Path) -> None:
    chance = random.Random(40)
    cases = [_case(chance) for _ in range(60)]
    script = """import(document.querySelector('script[src$="page.js"]').src.replace('page.js', 'body.js')).then(async (body) => {
        const model = await (await fetch('/head.json')).json();
        return %s.map(({ seen, arms, head, point, part, start, from, to, border, size }) => {
            const screen = body.screenOf(seen, ...size);
            return {
                turns: body.orientations(model.rods, arms, body.rotationOf(head)),
                place: body.onHead(screen, head, point),
                picked: body.picked(model, screen, head, ...from, 24),
                dragged: body.dragged({ screen, start: head, part, x: from[0], y: from[1] }, ...to, 35, 170),
                furthest: body.furthest(border, head),
            };
        });
    })"""
    with Browser(tmp_path, FULL) as browser:
        browser.open(f"http://127.0.0.1:{port}/")
        found = browser.run(script % json.dumps(cases))
    for case, result in zip(cases, found, strict=True):
        _compare(case, result)


def _case(chance: random.Random) -> dict[str, Any]:
    width, height = chance.uniform(300, 900), chance.uniform(200, 700)
    middle = width / 2 + chance.uniform(-90, 90), height * 0.4 + chance.uniform(-90, 90)
    return {
        "seen": {"azimuth": chance.uniform(-180, 180), "elevation": chance.uniform(-10, 80)},
        "size": (width, height),
        "arms": [chance.uniform(-1, 1) for _ in range(3)],
        "head": {name: round(chance.uniform(-most, most), 1) for name, most in (("yaw", 170), ("pitch", 20), ("roll", 20))},
        "point": [chance.uniform(-0.1, 0.1) for _ in range(3)],
        "part": chance.choice([*Part]),
        "from": middle,
        "to": (middle[0] + chance.uniform(-80, 80), middle[1] + chance.uniform(-80, 80)),
        "border": border_deg(35.0, 30.0),
    }  # fmt: skip


def _compare(case: dict[str, Any], result: dict[str, Any]) -> None:
    head = HeadOrientation(**case["head"])
    rows = rotation_of(*(math.radians(angle) for angle in (head.yaw, head.pitch, head.roll)))
    for path, turn in Figure().orientations(tuple(case["arms"]), rows).items():
        assert result["turns"][path] == pytest.approx(turn.ravel().tolist(), abs=1e-6), path
    camera = Viewpoint(**case["seen"], zoom=SEEN.zoom, height=SEEN.height)
    screen = Screen(camera, *case["size"])
    assert result["place"] == pytest.approx(
        screen.place(np.array([case["point"]]) @ np.array(rows).T)[0].tolist(), abs=1e-6
    )
    assert result["picked"] == picked(screen, head, *case["from"])
    drag = Drag(screen, head, Part(case["part"]), *case["from"])
    x, y = case["to"]
    to = drag.at(x, y, 35.0 * BEYOND, 170.0)
    assert [result["dragged"][name] for name in ("yaw", "pitch", "roll")] == pytest.approx(
        to.tenths, abs=0.11
    )
    assert result["furthest"] == pytest.approx(reach(tuple(case["border"]), head.pitch, head.roll), abs=1e-6)
