"""Programs of blocks in a real browser: built with the mouse, run on a robot, kept, within the content policy."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import Browser
from robots import Stage, until
from web_client import serving

from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import GESTURES

pytestmark = pytest.mark.long("a real browser")

WORKSPACE = "Blockly.getMainWorkspace()"


@pytest.fixture(scope="module")
def robot() -> Iterator[tuple[Stage, Robot]]:
    with Stage() as stage:
        stage.simulation("bea1")
        yield stage, stage.robot("bea1", "sim")


@pytest.fixture
def page(robot: tuple[Stage, Robot], tmp_path: Path) -> Iterator[Browser]:
    """A laptop with the tab of blocks, which drives the robot."""
    with serving(robot[0].endpoint) as port, Browser(tmp_path) as made:
        made.open(f"http://127.0.0.1:{port}/")
        made.wait(lambda: "Simulation" in made.text("#pills"), "the page")
        open_blocks(made)
        made.click("#drive")
        made.wait(lambda: "yours" in made.text("#pills"), "drives")
        made.run("document.querySelector('#pills > :first-child button').click()")  # it may still move
        made.wait(lambda: "Simulation: ready" in made.text("#pills"), "ready")
        yield made


def open_blocks(page: Browser) -> None:
    page.click("#tabs [data-tab=blocks]")
    page.wait(lambda: bool(page.run("Boolean(document.querySelector('.blocklyToolbox'))")), "the editor")


def program(page: Browser) -> dict[str, Any]:
    """Return the program in the editor."""
    saved: dict[str, Any] = json.loads(
        page.run(f"JSON.stringify(Blockly.serialization.workspaces.save({WORKSPACE}))")
    )
    return saved


def box(page: Browser, selector: str) -> tuple[float, float, float, float]:
    """Return left edge, top edge, width and height of an element (px), once it is there."""
    find = f"document.querySelector({json.dumps(selector)})"
    page.wait(lambda: bool(page.run(f"Boolean({find})")), selector)
    x, y, width, height = page.run(
        f"(({{ x, y, width, height }}) => [x, y, width, height])({find}.getBoundingClientRect())"
    )
    return x, y, width, height


def tap(page: Browser, selector: str) -> None:
    x, y, width, height = box(page, selector)
    page.drag((x + width / 2, y + height / 2), (x + width / 2, y + height / 2))


def add(page: Browser, category: int, block: str, below: str) -> None:
    """Drag a block out of the toolbox to the lower edge of another one."""
    row = "[...document.querySelectorAll('.blocklyToolboxCategory')][{}].id"
    tap(page, f"[id='{page.run(row.format(category))}']")
    x, y, *_ = box(page, f".blocklyFlyout .{block}")
    left, top, _, height = box(page, f"#workspace .{below} > .blocklyPath")
    page.drag((x + 8, y + 12), (left + 10, top + height + 8))


def type_number(page: Browser, block: str, number: str) -> None:
    """Type a number into the first input of a block."""
    tap(page, f"#workspace .{block} .math_number")
    page.wait(lambda: page.run("document.activeElement.className") == "blocklyHtmlInput", "the field")
    page.type(number)
    page.key("Enter")


def yaw(robot: Robot) -> float:
    return robot.positions().head.yaw


def check_phone(page: Browser) -> None:
    """Check that on a phone nothing is too wide, the open toolbox does not cover STOP, and all gestures are offered."""
    page.resize(360, 740, touch=True)
    tap(page, ".blocklyToolboxCategory")
    box(page, ".blocklyFlyout .turn")
    x, y, _, height = box(page, "#stop")
    on_top = f"document.elementFromPoint({x + 20}, {y + height / 2}).id"
    assert (page.run(on_top), page.run("document.documentElement.scrollWidth")) == ("stop", 360)

    page.run(f"void Blockly.serialization.blocks.append({{ type: 'gesture' }}, {WORKSPACE})")
    offered = (
        f"{WORKSPACE}.getBlocksByType('gesture')[0].getField('NAME').getOptions().map(([, name]) => name)"
    )
    assert tuple(page.run(offered))[: len(GESTURES)] == GESTURES  # after them those of the user


def test_a_pupil_builds_runs_and_stops_programs(
    page: Browser, robot: tuple[Stage, Robot], tmp_path: Path
) -> None:
    _, bea = robot
    add(page, 0, "turn", "start")
    type_number(page, "turn", "-20")
    page.click("#block-run")
    until(lambda: yaw(bea) == pytest.approx(-20.0, abs=0.5), "the head turns")
    page.wait(
        lambda: "robot.look(yaw=-20)" in page.run("document.querySelector('#block-code').value"), "Python"
    )
    page.click("#block-copy")
    assert page.text("#block-note") == "The Python program is copied."

    add(page, 1, "forever", "turn")
    page.click("#block-run")
    page.wait(lambda: page.run("Boolean(document.querySelector('.forever.blocklyHighlighted'))"), "it runs")
    page.key(" ")
    page.wait(lambda: page.run("!document.querySelector('.blocklyHighlighted')"), "STOP ends it")

    type_number(page, "turn", "400")
    until(lambda: not bea.status().moving, "at rest")
    page.wait(lambda: not page.run("document.querySelector('#block-run').disabled"), "Run")
    page.click("#block-run")
    page.wait(
        lambda: page.run("document.querySelector('#block-result').classList.contains('refused')"), "refused"
    )
    selected = page.run("Blockly.common.getSelected().type")
    assert (selected, "400" in page.text("#block-result")) == ("turn", True)

    kept = program(page)
    page.wait(lambda: page.text("#block-note").startswith("Saved"), "saved")
    page.open(page.run("location.href"))
    page.wait(
        lambda: page.run("Boolean(window.Blockly?.getMainWorkspace()?.getBlocksByType('turn').length)"),
        "again",
    )
    assert program(page) == kept

    check_phone(page)
    assert page.errors() == []
