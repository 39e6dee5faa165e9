"""Make docs/images/class-*.png: the slips of a class, the page of a pupil and that of the teacher, in Chromium.

Usage: .venv/bin/python tools/class_pictures.py [DIR]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/support"))

from bench_node import ROOT, Served
from browser import Browser

from beatrix_zenoh import class_file, class_words
from beatrix_zenoh.classroom import provision
from beatrix_zenoh.processes import free_port

CLASS: Final = """name = "8b"
addresses = ["127.0.0.1"]
seats = 15

[router]
port = {port}
page = {page}
"""
SLIPS: Final = (692, 264)
TABLET: Final = (1024, 700)
PRINTED: Final = "http://192.168.1.20:8088/"
"""The address on the slips of the picture."""
TEACHER: Final = "teacher"


@contextmanager
def served(file: Path, teacher: Path) -> Iterator[None]:
    """Run everything that `beatrix up --class` runs."""
    programs = [("router", "--class"), ("sim", "--ready", "--seats"), ("web", "--class")]
    started = []
    try:
        for words in programs:
            account = None if words[0] == "router" else teacher
            started.append(Served("beatrix_zenoh.cli", *words, str(file), account=account))
        yield
    finally:
        for process in reversed(started):
            process.end()


def log_in(page: Browser, address: str, word: str) -> None:
    """Open the page of a seat by its word."""
    page.open(address)
    page.run(f"document.querySelector('#typed').value = '{word}', document.querySelector('form').submit()")
    page.wait(lambda: "ready" in page.text("#pills"), "the head of the seat")


def program() -> dict[str, object]:
    """Return the program of the first question of the lesson, as Blockly saves it."""
    block: dict[str, object] = {"type": "home"}
    for angle in (-5, 15):
        number = {"shadow": {"type": "math_number", "fields": {"NUM": angle}}}
        block = {"type": "nod", "inputs": {"ANGLE": number}, "next": {"block": block}}
    return {"blocks": {"blocks": [{"type": "start", "x": 24, "y": 24, "next": {"block": block}}]}}


def draw(file: Path, folder: Path, pictures: Path) -> None:
    """Draw the pictures of a class that is served."""
    address, words = class_file.read(file).page, class_words.read(folder).words
    with TemporaryDirectory() as profile, Browser(Path(profile), TABLET) as page:
        page.pretend_graphics_chip()
        log_in(page, address, words["seat03"])
        page.click("#tabs [data-tab=lessons]")
        page.wait(lambda: bool(page.run("Boolean(document.querySelector('.blocklyToolbox'))")), "the editor")
        page.run(
            f"Blockly.serialization.workspaces.load({json.dumps(program())}, Blockly.getMainWorkspace())"
        )
        page.wait(lambda: page.text(".blocklyBlockCanvas").count("nod") == 2, "the blocks")
        page.run("document.getElementById('notice').hidden = true")  # of a computer that was busy
        page.picture(pictures / "class-lesson.png")
        page.call("Network.clearBrowserCookies")
        log_in(page, address, words[TEACHER])
        page.click("#tabs [data-tab=drive]")
        page.wait(lambda: page.text("#class tbody").count("ready") == 15, "the class")
        page.picture(pictures / "class-teacher.png")
        page.resize(*SLIPS)
        page.open((folder / provision.SHEET).as_uri())
        page.run("document.documentElement.style.overflow = 'hidden'")
        page.run(f"document.body.innerHTML = document.body.innerHTML.replaceAll('{address}', '{PRINTED}')")
        page.picture(pictures / "class-words.png")


def main() -> None:
    """Make a class, and draw its pictures."""
    pictures = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/images"
    with TemporaryDirectory() as own:
        file = Path(own) / "class.toml"
        file.write_text(CLASS.format(port=free_port(), page=free_port()), encoding="utf-8")
        described = class_file.read(file)
        folder = class_file.folder(file, described)
        provision.init(described, folder)
        with served(file, folder / "seats" / f"{TEACHER}.toml"):
            draw(file, folder, pictures)


if __name__ == "__main__":
    main()
