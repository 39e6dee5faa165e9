"""Photos and films on the page: the browser makes them, and a seat shows them to its class."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path

import av
import numpy as np
import pytest
from browser import Browser
from class_router import CLI, ClassRouter
from PIL import Image
from robots import Process
from web_client import WebClient

from beatrix_zenoh import class_words as words
from gui.page.gallery import BYTES_MAX, SHOWN_MAX, Gallery

PNG = b"\x89PNG\r\n\x1a\n and the rest"
WEBM, MP4 = b"\x1a\x45\xdf\xa3\x42\x82\x84webm", b"\0\0\0\x20ftypisom"


def shown(browser: WebClient) -> list[list[str]]:
    found: list[list[str]] = json.loads(browser.fetch("/gallery").body)["shown"]
    return found


def test_the_class_sees_what_a_seat_has_shown_and_only_the_teacher_deletes_it(
    browsers: dict[str, WebClient], router: ClassRouter
) -> None:
    ana, ben, teacher = browsers["ana"], browsers["ben"], browsers["teacher"]
    for content in (PNG, MP4, WEBM):
        assert ana.fetch("/gallery", content).body == b"page.shown"
    assert [Path(file).suffix for _, file, name in shown(ben) if name == "ana"] == [".webm", ".mp4", ".png"]
    seat, file, _ = shown(ben)[-1]
    path = f"/gallery/{seat}/{file}"
    seen = ben.fetch(path)
    assert (seen.body, seen.headers["Content-Type"]) == (PNG, "image/png")
    for browser in (ben, ana, browsers[""]):
        assert browser.fetch(path, method="DELETE").code == 403
    assert teacher.fetch(path, method="DELETE", **{"X-XSRFToken": ""}).code == 403
    assert teacher.fetch(path, method="DELETE").code == 200
    assert len(shown(teacher)) == 2
    assert {one.name for one in (router.folder / "gallery").iterdir()} == {"ana"}


@pytest.mark.parametrize(
    ("body", "headers"),
    [
        (b"<html><script>", {}),
        (b"", {}),
        (PNG + bytes(BYTES_MAX), {}),
        *((PNG, {name: value}) for name, value in {"Origin": "http://evil", "X-XSRFToken": "", "Cookie": ""}.items()),
    ],
)  # fmt: skip
def test_other_content_and_other_pages_are_refused(
    browsers: dict[str, WebClient], body: bytes, headers: dict[str, str]
) -> None:
    before = shown(browsers["ben"])
    with contextlib.suppress(OSError):  # the server closes the connection
        assert browsers["ben"].fetch("/gallery", body, **headers).body != b"page.shown"
    assert shown(browsers["ben"]) == before


def test_guests_see_nothing_and_no_name_leads_to_another_file(
    browsers: dict[str, WebClient], router: ClassRouter
) -> None:
    browsers["ana"].fetch("/gallery", PNG)
    seat, file, _ = shown(browsers["ana"])[0]
    for path in ("/gallery", f"/gallery/{seat}/{file}"):
        assert browsers[""].fetch(path).code == 403
    for path in (
        "ben/" + file,
        "%2e%2e/" + file,
        "..%2fprograms/1.png",
        "ana/1.png",
        "ana/..%2f..%2fclass.toml",
    ):
        assert browsers["ana"].fetch("/gallery/" + path).code == 404, path


def test_a_folder_keeps_the_newest_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gallery = Gallery(tmp_path)
    for moment in range(SHOWN_MAX + 3):
        monkeypatch.setattr("gui.page.gallery.time.time_ns", lambda at=moment: (10**9 + at) * 10**9)
        gallery.keep("ana", b"%d" % moment, ".png")
    found = [gallery.path(*one) for one in gallery.listed()]
    assert [int(path.read_bytes()) for path in found if path] == [*range(SHOWN_MAX + 2, 2, -1)]


@pytest.mark.long("a real browser")
def test_a_pupil_photographs_films_and_shows_the_head(
    port: int, router: ClassRouter, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path("teacher")))
    shutil.rmtree(router.folder / "gallery", ignore_errors=True)  # what other tests have shown
    simulation = Process(*CLI, "sim", "--seats", str(router.class_file), "--ready")
    simulation.expect("ready")
    with Browser(tmp_path / "profile") as browser:
        browser.pretend_graphics_chip()  # with WebGL, whose picture is lost after it was drawn
        log_in(browser, port, words.read(router.folder).words["ana"])
        browser.wait(lambda: browser.run("document.body.matches(':not(.idle)')"), "the page drives")
        browser.click("#photo")
        photo = Image.open(sent(browser, router, ".png")).convert("RGB")
        irises = np.asarray(photo).astype(int)[:520]
        assert photo.size == (960, 780)
        assert ((irises[..., 2] - irises[..., 0] > 50) & (irises[..., 1] > 90)).sum() > 500
        browser.click("#shot-close")
        browser.click("#film")
        browser.wait(lambda: browser.text("#film") == "■ 0:02", "the clock of the film")
        browser.click("#film")
        with av.open(str(sent(browser, router, ".[mw]*"))) as film:
            assert sum(1 for _ in film.decode(video=0)) > 5
        browser.open(f"http://127.0.0.1:{port}/class")
        browser.wait(lambda: "(2)" in browser.text("#pictures"), "the gallery")
        browser.click("#pictures")
        films = "[...document.querySelectorAll('#gallery video')].filter((one) => one.readyState >= 2).length"
        browser.wait(lambda: browser.run(films) == 1, "the film can be played")
        assert browser.text("#gallery p") == "▶ ana"
        assert browser.errors() == []
    simulation.end()


def log_in(browser: Browser, port: int, word: str) -> None:
    browser.open(f"http://127.0.0.1:{port}/")
    browser.click("input[name=typed]")
    browser.type(word)
    browser.click("button")
    browser.wait(lambda: bool(browser.run("Boolean(document.querySelector('#bodies'))")), "the page")


def sent(browser: Browser, router: ClassRouter, ending: str) -> Path:
    """Show the photo or film that the page has just made, and return its file on the computer of the teacher."""
    browser.wait(lambda: browser.run("!document.querySelector('#shot').hidden"), ending)
    browser.click("#shot-show")
    browser.wait(lambda: "/class" in browser.text("#shot-note"), "shown")
    return max((router.folder / "gallery/ana").glob(f"*{ending}"))
