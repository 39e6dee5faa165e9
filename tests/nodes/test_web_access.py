"""Access to the control page, and the verb that serves it. Real server and router."""

from __future__ import annotations

import contextlib
import json
import re
import signal
import socket
from collections.abc import Iterator
from typing import Any

import pytest
from robots import EVENT_S, Process, Stage, until
from shell import CLI, beatrix
from tornado.websocket import WebSocketClosedError
from web_client import PIN, WebClient, serving

from beatrix_zenoh.processes import free_port
from gui.page import app as web
from gui.page import server
from gui.page.server import ADDRESS_MAX


@pytest.fixture(scope="module")
def port(router: Stage) -> Iterator[int]:
    with serving(router.endpoint) as made:
        yield made


@pytest.fixture
def browser(port: int) -> Iterator[WebClient]:
    """A browser that has loaded the page."""
    with WebClient(port) as made:
        made.load()
        yield made


# -- access -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example:{port}", "Origin": "http://evil.example:{port}"},
        {"Origin": "http://evil.example"},
        {"Origin": ""},
        {"Cookie": ""},
        {"Cookie": "beatrix-{port}=guessed"},
    ],
)
@pytest.mark.parametrize("path", ["/live", "/pictures?robot=bea1&side=hw"])
def test_web_sockets_of_foreign_pages_are_refused(
    browser: WebClient, path: str, headers: dict[str, str]
) -> None:
    sent = {name: value.format(port=browser.port) for name, value in headers.items()}
    code, sentence = browser.refusal(path, **sent)
    assert (code, sentence.endswith(".")) == (403, True)


@pytest.mark.parametrize(
    "headers", [{"Origin": "http://evil.example"}, {"Origin": ""}, {"X-XSRFToken": ""}, {"Cookie": ""}]
)
def test_a_foreign_page_cannot_send_stop(browser: WebClient, headers: dict[str, str]) -> None:
    body = json.dumps({"do": "stop", "robot": "bea1", "stop": "1"})
    assert browser.fetch("/stop", body, **headers).code == 403


def test_guests_have_no_gallery(browser: WebClient) -> None:
    assert browser.fetch("/gallery").code == browser.fetch("/gallery", "PNG").code == 403


def test_a_page_that_is_embedded_in_a_foreign_page_gets_no_cookies(port: int) -> None:
    with WebClient(port) as browser:
        response = browser.fetch("/", **{"Sec-Fetch-Dest": "iframe"})
    assert (response.code, browser.cookies) == (403, {})


def test_every_reply_forbids_foreign_content_and_frames(browser: WebClient) -> None:
    for path in ("/", "/static/page.js", "/nowhere"):
        headers = browser.fetch(path).headers
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "frame-ancestors 'none'" in policy
        assert (headers["X-Frame-Options"], headers["Cache-Control"]) == ("DENY", "no-store")
        assert "Access-Control-Allow-Origin" not in headers


def test_browsers_keep_compressed_files_until_one_of_them_changes(browser: WebClient) -> None:
    (script,) = re.findall(r'src="(/static/[^"]+)"', browser.fetch("/").body.decode())
    reply = browser.fetch(script)  # this client asks for gzip, and decompresses it
    assert "immutable" in reply.headers["Cache-Control"]
    assert int(reply.headers["Content-Length"]) < len(reply.body) / 2
    folder = script.rpartition("/")[0]
    for path in (f"{folder}/../server.py", f"{folder}/page.html", "/static/0123/page.js", f"{folder}/"):
        assert browser.fetch(path).code == 404, path


def test_cookies_are_for_this_page_only(port: int) -> None:
    with WebClient(port) as browser:
        cookies = browser.fetch("/").headers.get_list("Set-Cookie")
        cookies += browser.fetch("/").headers.get_list("Set-Cookie")
    assert len(cookies) == 2
    assert all("SameSite=Strict" in cookie and "HttpOnly" in cookie for cookie in cookies)


def test_the_editor_of_blocks_is_compressed_and_its_page_allows_no_foreign_scripts(
    browser: WebClient,
) -> None:
    folder = "/static/vendor/blockly-12.5.1"
    reply = browser.fetch(f"{folder}/blockly_compressed.js")
    assert int(reply.headers["Content-Length"]) < 250_000 < len(reply.body)
    policy = browser.fetch("/").headers["Content-Security-Policy"]
    assert "script-src 'self';" in policy
    assert "style-src-attr" not in browser.fetch("/class").headers["Content-Security-Policy"]
    for path in (
        f"{folder}/../../page.html",
        f"{folder}/LICENSE",
        "/static/vendor/",
        "/static/vendor/../page.js",
    ):
        assert browser.fetch(path).code == 404, path


@pytest.mark.parametrize(
    ("message", "note"),
    [
        ({"do": "save_program", "name": "../ben/x", "program": "{}"}, "page.program_name"),
        ({"do": "save_program", "name": "large", "program": "x" * 66000}, "page.program_large"),
        ({"do": "open_program", "name": "../../account"}, "page.program_missing"),
        ({"do": "open_program", "name": "own", "seat": "ben"}, "page.program_foreign"),
        ({"do": "save_program", "name": "own", "program": "{}"}, "page.program_saved"),
    ],
)
def test_a_hostile_program_gets_a_sentence(browser: WebClient, message: dict[str, str], note: str) -> None:
    page = browser.connect()
    page.send_raw(json.dumps(message))
    view = page.state(lambda view: view["programs"]["note"][0] == note, note)
    assert set(view["programs"]["names"]) <= {"own"}


UNREADABLE = ("", "{", '{"do":"HoldArm","arm":"nose","sign":1}', '{"do":"StartSimulation"}', "x" * 100)


@pytest.mark.parametrize("text", UNREADABLE)
def test_a_message_that_cannot_be_read_closes_the_web_socket(browser: WebClient, text: str) -> None:
    page = browser.connect()
    page.send_raw(text)
    until(lambda: page.read() is None, "closed")
    assert page.code == 4002


def test_the_web_socket_of_a_page_that_floods_is_closed(browser: WebClient) -> None:
    page = browser.connect()
    with contextlib.suppress(WebSocketClosedError):
        for _ in range(1000):
            page.send("beat")
    until(lambda: page.read() is None, "closed")
    assert page.code == 4001


def test_too_many_connections_of_an_address_are_closed(router: Stage) -> None:
    with serving(router.endpoint) as port, contextlib.ExitStack() as flood:
        made = [
            flood.enter_context(socket.create_connection(("127.0.0.1", port))) for _ in range(ADDRESS_MAX + 1)
        ]
        made[-1].settimeout(EVENT_S)
        assert made[-1].recv(1) == b""
        flood.close()
        with WebClient(port) as browser:
            until(lambda: served(browser), "served again")


def served(browser: WebClient) -> bool:
    """Return whether the server accepts a connection again; it may still close one."""
    try:
        return browser.fetch("/").code == 303
    except ConnectionError:
        return False


# -- PIN -----------------------------------------------------------------------------------------------


@pytest.fixture
def locked(router: Stage, monkeypatch: pytest.MonkeyPatch) -> Iterator[WebClient]:
    """A browser of a server with a PIN. The server uses loopback only, because tests must not open other ports."""
    monkeypatch.setattr(server, "ALL", server.LOOPBACK)
    with serving(router.endpoint, pin=PIN) as port, WebClient(port) as made:
        yield made


def test_the_page_needs_the_pin(locked: WebClient) -> None:
    assert 'name="typed"' in locked.load()
    assert locked.refusal() == (403, "This browser is not logged in. Load the control page again.")
    assert "class.js" not in locked.fetch("/class").body.decode(), "the projector needs it, too"
    wrong = locked.log_in("000000")
    assert wrong.code == 403
    assert "This PIN is wrong." in wrong.body.decode()
    assert locked.log_in(PIN).code == 303
    assert 'id="stop"' in locked.load()
    assert locked.connect().read() is not None


def test_a_pin_of_a_foreign_page_is_not_checked(locked: WebClient) -> None:
    locked.load()
    assert locked.fetch("/", f"typed={PIN}", Origin="http://evil.example").code == 403
    assert list(locked.cookies) == ["_xsrf"]


# -- the verb ------------------------------------------------------------------------------------------


def test_the_verb_prints_its_url_and_ends_with_ctrl_c(router: Stage) -> None:
    words = ("--connect", router.endpoint, "--who", "ana", "--port", str(free_port()))
    process = Process(*CLI, "web", *words)
    process.expect(f"ready http://127.0.0.1:{words[-1]}/")
    assert process.end(signal.SIGINT) == 0


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (("--port", "{port}"), 1, "Choose another one with --port"),
        (("--who", "teacher"), 1, "could take robots from all other seats"),
        (("--connect", "tcp/127.0.0.1:{port}", "--port", "{free}"), 3, "router"),
    ],
)
def test_the_error_of_the_verb_names_the_cause(
    router: Stage, port: int, words: tuple[str, ...], code: int, sentence: str
) -> None:
    given = [word.format(port=port, free=free_port()) for word in words]
    more = [] if "--connect" in words else ["--connect", router.endpoint]
    done = beatrix("web", *more, *given)
    assert done.returncode == code
    assert sentence in done.stderr


async def announce(*_: object, **given: Any) -> None:
    """Serve nothing, and say that the page is ready."""
    given["ready"](8088)


def test_with_lan_the_verb_prints_a_pin_but_never_that_of_the_environment(
    router: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web, "own_address", lambda: "192.168.1.20")
    monkeypatch.setattr(server, "serve", announce)
    printed = beatrix("web", "--lan")
    assert re.search(r"^PIN: \d{6}$", printed.stderr, re.MULTILINE)
    assert "ready http://192.168.1.20:8088/" in printed.stdout
    monkeypatch.setenv("BEATRIX_WEB_PIN", PIN)
    assert PIN not in (done := beatrix("web", "--lan")).stderr + done.stdout
    assert "PIN: the one in BEATRIX_WEB_PIN" in done.stderr
    monkeypatch.setenv("BEATRIX_WEB_PIN", "1")
    assert beatrix("web", "--lan").returncode == 2
