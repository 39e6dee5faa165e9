"""Lessons in a real browser: running the blocks of a lesson is its check."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Browser
from robots import Stage
from web_client import serving

from beatrix_zenoh.lesson_files import LIBRARY

pytestmark = pytest.mark.long("a real browser, and programs that move a robot in real time")
TRIES = 3
NOD = """{"blocks": {"blocks": [{"type": "start", "id": "s", "x": 20, "y": 20, "next": {"block":
{"type": "nod", "id": "a", "inputs": {"ANGLE": {"shadow": {"type": "math_number", "fields": {"NUM": 12}}}},
"next": {"block": {"type": "home", "id": "b"}}}}}]}}"""


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Browser]:
    """A laptop with the tab of lessons, which drives a robot that is ready."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with Stage() as stage:
        stage.simulation("bea1")
        with serving(stage.endpoint) as port, Browser(tmp_path) as made:
            made.open(f"http://127.0.0.1:{port}/")
            made.wait(lambda: "Simulation" in made.text("#pills"), "the page")
            made.click("#drive")
            made.wait(lambda: "yours" in made.text("#pills"), "drives")
            made.click("#pills > :first-child button")
            made.wait(lambda: "Simulation: ready" in made.text("#pills"), "ready")
            made.click("#tabs [data-tab=lessons]")
            made.wait(lambda: bool(made.run("Boolean(document.querySelector('.blocklyToolbox'))")), "blocks")
            yield made


def verdict(page: Browser, program: str) -> str:
    """Put a program into the editor, run it, and return the verdict; skip the test on a computer that is too busy."""
    state = f"JSON.parse({json.dumps(program)})"
    found = ""
    for _ in range(TRIES):
        page.run(f"Blockly.serialization.workspaces.load({state}, Blockly.getMainWorkspace())")
        page.wait(lambda: not page.run("document.querySelector('#block-run').disabled"), "Run")
        page.click("#block-run")
        page.wait(lambda: "watches" in page.text("#lesson-check"), "the check")
        page.wait(lambda: "watches" not in page.text("#lesson-check"), "the verdict")
        found = page.text("#lesson-check")
        if not re.match("Not measured|The run was ended", found):  # heartbeats of the page come too late, too
            return found
    pytest.skip(f"{found} {page.text('#notice')}")


def test_run_is_the_check_of_a_lesson(page: Browser) -> None:
    page.wait(lambda: "say yes and no" in page.text("#lesson-text"), "the text")
    page.wait(
        lambda: page.run("document.querySelector('#block-programs').selectedOptions[0].text") == "01-hello",
        "its program",
    )
    assert page.run("document.querySelectorAll('.blocklyToolboxCategory').length") == 3
    page.click("#lesson-hint")
    page.wait(lambda: "2 left" in page.text("#lesson-hint"), "a hint")
    assert "three ways" in page.text("#lesson-hints")
    assert "*" not in page.text("#lesson-hints")
    assert "at least 4 swings of the nose of 8° or more" in verdict(page, NOD)
    page.wait(
        lambda: page.run("document.querySelector('#lesson-check img')?.naturalWidth === 720"), "the picture"
    )
    solution = (LIBRARY / "01-hello/solution.json").read_text(encoding="utf-8")
    assert verdict(page, solution).startswith("Passed: Hello, head.")
    assert page.run("document.querySelector('#lesson-list').options[0].text").startswith("✓")
    assert page.errors() == []
    page.click("#tabs [data-tab=blocks]")
    page.wait(
        lambda: page.run("document.querySelectorAll('.blocklyToolboxCategory').length") == 4, "all blocks"
    )
