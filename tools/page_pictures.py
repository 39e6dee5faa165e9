"""Make docs/images/web-page*.png: the control page on a laptop and on a phone, in Chromium without a screen.

Usage: .venv/bin/python tools/page_pictures.py [DIR]
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/support"))

from bench_node import ROOT, Served, free_endpoint
from browser import Browser
from web_client import serving

from beatrix_zenoh.lesson_files import LIBRARY

NAME: Final = "bea1"
LAPTOP: Final = (1366, 768)
PHONE: Final = (390, 844)
LEAD_S: Final = 5
SHOWN_S: Final = 2.5
"""Time from the start of the countdown to the picture: the simulation has arrived, the hardware waits."""
EYES: Final = "[...document.images].filter((image) => image.naturalWidth > 0 && image.offsetWidth > 0).length"

EDITOR: Final = "Boolean(document.querySelector('.blocklyToolbox'))"


@contextmanager
def robots() -> Iterator[str]:
    """Run a router, a simulation and a virtual robot; yield the endpoint of the router."""
    endpoint = free_endpoint()
    where = ("--name", NAME, "--connect", endpoint)
    served = [Served("beatrix_zenoh.cli", "router", "--listen", endpoint)]
    try:
        served.append(Served("sim_node", *where))
        served.append(Served("hw_node", *where, "--port", "virtual:"))
        yield endpoint
    finally:
        for process in reversed(served):
            process.end()


def choose(page: Browser, selector: str, value: str | int, event: str = "change") -> None:
    """Set an input of the page as a user does."""
    field = f"document.querySelector({json.dumps(selector)})"
    page.run(f"{field}.value = {json.dumps(value)}, {field}.dispatchEvent(new Event('{event}'))")


def drive(page: Browser) -> None:
    """Take both robots, and make them ready."""
    choose(page, "#name", "Mia", "input")
    page.click("#drive")
    page.wait(lambda: page.text("#pills").count("yours") == 2, "drives")
    page.click("#hw")
    for pill, step in (("first", "Make ready"), ("last", "Enable"), ("last", "Calibrate")):
        button = f"#pills > :{pill}-child button"
        page.wait(lambda button=button, step=step: page.text(button) == step, step)  # type: ignore[misc]
        page.click(button)
        if pill == "first":
            page.wait(lambda: "Simulation: ready" in page.text("#pills"), "the simulation is ready")
    page.wait(lambda: page.text("#pills").count("ready") == 2, "both are ready")


def laptop(page: Browser, file: Path) -> None:
    """Send a motion to both robots, and draw the page while the hardware waits."""
    drive(page)
    page.click("#looking")
    page.wait(lambda: page.run(EYES) == 2, "both eyes")
    choose(page, "#lead", LEAD_S)
    choose(page, "#aim-yaw", 25, "input")
    choose(page, "#aim-pitch", 10, "input")
    page.click("#send")
    page.wait(lambda: "hardware follows in" in page.text("#countdown"), "the simulation leads")
    page.run("scrollTo(0, 0)")
    time.sleep(SHOWN_S)
    page.picture(file)
    page.wait(lambda: "hardware follows in" not in page.text("#countdown"), "the hardware follows")
    page.wait(lambda: page.text("#pills").count("ready") == 2, "both have arrived")


def turn(degrees: float, below: object = None) -> dict[str, object]:
    """Return a block that turns the head, and the blocks below it, as Blockly saves them."""
    angle = {"shadow": {"type": "math_number", "fields": {"NUM": degrees}}}
    under = {} if below is None else {"next": {"block": below}}
    return {"type": "turn", "inputs": {"ANGLE": angle}, **under}


def blocks(page: Browser, file: Path) -> None:
    """Run a program of blocks on the simulation, and draw its second turn."""
    page.click("#hw")
    page.click("#tabs [data-tab=blocks]")
    page.wait(lambda: bool(page.run(EDITOR)), "the editor")
    times = {"shadow": {"type": "math_number", "fields": {"NUM": 3}}}
    row = {"block": turn(-40, turn(40, {"type": "gesture", "fields": {"NAME": "curious"}}))}
    repeat = {"type": "controls_repeat_ext", "inputs": {"TIMES": times, "DO": row}}
    program = {"blocks": {"blocks": [{"type": "start", "x": 24, "y": 24, "next": {"block": repeat}}]}}
    page.run(f"Blockly.serialization.workspaces.load({json.dumps(program)}, Blockly.getMainWorkspace())")
    page.click("#block-run")
    second = ".turn .turn.blocklyHighlighted"
    page.wait(lambda: page.run(f"Boolean(document.querySelector('{second}'))"), "the second turn")
    page.picture(file)
    page.click("#stop")
    page.click("#tabs [data-tab=drive]")


def lesson(page: Browser, file: Path) -> None:
    """Run the solution of the first lesson, and draw what the check says."""
    solution = json.dumps((LIBRARY / "01-hello/solution.json").read_text(encoding="utf-8"))
    chosen = "document.querySelector('#block-programs').selectedOptions[0]?.text === '01-hello'"
    page.click("#tabs [data-tab=lessons]")
    page.wait(lambda: bool(page.run(f"{EDITOR} && {chosen}")), "the lesson")
    page.run(f"Blockly.serialization.workspaces.load(JSON.parse({solution}), Blockly.getMainWorkspace())")
    page.click("#block-run")
    page.wait(lambda: page.text("#lesson-check").startswith("Passed"), "the check")
    page.picture(file)
    page.click("#tabs [data-tab=drive]")


def phone(page: Browser, file: Path) -> None:
    """Ask for a motion beyond the limits in German, and draw the refusal."""
    choose(page, "#language", "de")
    page.wait(lambda: page.text("#drive") == "Zurückgeben", "German")
    page.resize(*PHONE, touch=True)
    choose(page, "#aim-pitch", 30, "input")
    choose(page, "#aim-roll", 30, "input")
    page.click("#send")
    page.wait(lambda: "35,0°" in page.text("#refusal-head p"), "a refusal beside the sliders")
    page.run("scrollTo(0, 0)")
    time.sleep(1.0)  # the page may still scroll
    page.picture(file)


def main() -> None:
    """Start robots, and draw the pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/images"
    with TemporaryDirectory() as own, robots() as endpoint:
        os.environ["XDG_CONFIG_HOME"] = own  # where the page keeps programs of blocks
        draw(endpoint, Path(own), folder)


def draw(endpoint: str, profile: Path, folder: Path) -> None:
    """Start server and browser, and draw the pictures."""
    with serving(endpoint) as port, Browser(profile, LAPTOP) as page:
        page.pretend_graphics_chip()
        page.open(f"http://127.0.0.1:{port}/")
        page.wait(lambda: "motors off" in page.text("#pills"), "the page")
        laptop(page, folder / "web-page.png")
        blocks(page, folder / "web-page-blocks.png")
        lesson(page, folder / "web-page-lesson.png")
        phone(page, folder / "web-page-phone.png")


if __name__ == "__main__":
    main()
