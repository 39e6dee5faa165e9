"""The page for a projector in a real browser: sizes, long names, both languages."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import msgspec
import pytest
from browser import Browser
from gui_views import turns

from gui.console.state import class_page
from gui.console.texts import LANGUAGES, Texts, load
from gui.page.static_files import STATIC

pytestmark = pytest.mark.long("a real browser")
CONNECTION = """
export function connect(receive) { window.receive = receive; }
export function send() {}
export function trouble() { return ""; }
"""
"""Takes the place of the web socket: the test gives the views to the page."""
MEASURED = """(() => {
  const place = (element) => element.getBoundingClientRect();
  const leaves = (box, outer) => box.left < outer.left - 1 || box.right > outer.right + 1
    || box.top < outer.top - 1 || box.bottom > outer.bottom + 1;
  return [...document.querySelectorAll("#turns li")].map((item) => ({
    bottom: place(item).bottom,
    parts: [...item.querySelectorAll(".robot, .side, .state, .left, .driver, .next")].filter((part) => part.textContent)
      .map((part) => ({ kind: part.className, text: part.textContent, px: parseFloat(getComputedStyle(part).fontSize),
        cut: leaves(place(part), place(item)) || part.scrollWidth > part.clientWidth + 1
          || part.scrollHeight > part.clientHeight + parseFloat(getComputedStyle(part).fontSize) / 2 })),
  }));
})()"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A browser that shows a copy of the page."""
    folder = tmp_path_factory.mktemp("page")
    files = shutil.copytree(STATIC, folder / "static")
    (files / "connection.js").write_text(CONNECTION)
    (folder / "gallery").write_text('{"shown": [], "teacher": false}')
    page = files / "class.html"
    page.write_text(page.read_text().replace("{{ static }}", "/static"))
    handler = partial(SimpleHTTPRequestHandler, directory=folder)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            with Browser(tmp_path_factory.mktemp("browser")) as browser:
                browser.open(f"http://127.0.0.1:{server.server_port}/static/class.html")
                yield browser
        finally:
            server.shutdown()
            thread.join()


def show(
    page: Browser, count: int, size: tuple[int, int], language: str, *, long: bool
) -> list[dict[str, Any]]:
    """Return the robots with the places, sizes and texts of their parts."""
    page.resize(*size)
    rows = class_page.table(turns(count, long=long), Texts(language))
    shown = [{"cells": row.cells, "condition": row.condition} for row in rows]
    view = {"language": language, "texts": dict(load(language)[0]), "class": shown, "empty": ""}
    page.run(f"receive({msgspec.json.encode(view).decode()})")
    measured: list[dict[str, Any]] = page.run(MEASURED)
    assert len(measured) == count
    return measured


READ = {"robot", "driver", "next"}
"""What is read from the last row of a class."""


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("size", [(1366, 768), (1920, 1080), (1024, 768)])
@pytest.mark.parametrize("count", [1, 3, 8, 30])
def test_robots_fill_the_screen_and_no_text_leaves_its_robot(
    page: Browser, count: int, size: tuple[int, int], language: str
) -> None:
    robots = show(page, count, size, language, long=True)
    large = count < 8 and size[0] > 1024  # six hundredths of the height
    for robot in robots:
        for part in robot["parts"]:
            assert not part["cut"], part
            assert not large or part["kind"] not in READ or part["px"] >= 0.06 * size[1], part
    assert page.run("document.documentElement.scrollHeight") <= size[1]
    assert page.run("document.documentElement.scrollWidth") <= size[0]
    assert robots[-1]["bottom"] > 0.9 * size[1], "no empty space below"
    assert page.run("document.querySelector('#hint').getBoundingClientRect().bottom") <= size[1]
    assert page.errors() == []


def test_a_robot_shows_its_driver_the_time_left_the_queue_and_why_it_does_not_move(page: Browser) -> None:
    robots = [
        {part["kind"]: part["text"] for part in robot["parts"]}
        for robot in show(page, 8, (1920, 1080), "en", long=False)
    ]
    assert (robots[2]["driver"], robots[2]["left"]) == ("Cleo Müller (cleo) (taken)", "43 s")
    assert robots[2]["next"] == "Next: Dora Müller (dora), Emil Müller (emil)"
    assert (robots[3]["side"], robots[3]["state"]) == ("Simulation", "■ frozen")
    assert (robots[5]["driver"], "state" in robots[5]) == ("free", False)
