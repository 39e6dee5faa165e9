"""Levels in the page and in the window's link: microphones are on while they are watched, and off afterwards."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from robots import Stage, wait_status
from web_client import WebClient, serving

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Status

MARK = "microphones on"


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.hardware("bea1", "virtual:", "--microphones", "tone")
        yield made


@pytest.fixture
def robot(stage: Stage) -> Iterator[Robot]:
    robot = stage.robot("bea1", "hw")
    yield robot
    robot.client.close()


def listening(status: Status) -> bool:
    return status.microphones is not None and status.microphones.streaming


def hardware(view: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = view["sound"]["levels"][1]
    return found


def test_a_page_shows_levels_and_the_mark_only_while_its_box_is_checked(stage: Stage, robot: Robot) -> None:
    with serving(stage.endpoint) as port, WebClient(port) as browser:
        browser.load()
        page = browser.connect()
        page.state(lambda view: not view["sound"]["on"] and "pills" in view, "the box is not checked")
        page.send("Choose", name="microphones", value=True)
        view = page.state(lambda view: hardware(view)["left"] > 0, "a level")
        assert hardware(view)["text"].startswith("left -")
        page.state(lambda view: any(MARK in note for note in view["pills"][1]["notes"]), "the mark")
        page.send("Choose", name="microphones", value=False)
        wait_status(robot, lambda status: not listening(status), "the microphones are off")
        page.state(lambda view: not any(MARK in note for note in view["pills"][1]["notes"]), "the mark")
        page.send("Choose", name="microphones", value=True)
        wait_status(robot, listening, "they are on again")
        page.close()
        wait_status(robot, lambda status: not listening(status), "a closed page does not listen")
