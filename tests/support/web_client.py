"""A server of the control page in this process, and a client that sends requests of browsers, or forged ones."""

from __future__ import annotations

import asyncio
import contextlib
import json
import queue
import re
import threading
from collections.abc import Awaitable, Callable, Iterator
from http.cookies import SimpleCookie
from typing import Any, Self, TypeVar

from robots import EVENT_S, PATIENCE_S, until
from tornado.httpclient import HTTPRequest, HTTPResponse
from tornado.simple_httpclient import SimpleAsyncHTTPClient
from tornado.websocket import websocket_connect

from beatrix_zenoh.account import Account
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import Shutdown
from gui.page import server
from gui.page.protection import Login, PinLogin

T = TypeVar("T")
PIN = "246810"


@contextlib.contextmanager
def serving(
    endpoint: str,
    *,
    only: str | None = None,
    pin: str | None = None,
    account: Account | None = None,
    login: Login | None = None,
) -> Iterator[int]:
    """Serve the page on loopback; yields the port."""
    shutdown, ports = Shutdown(), queue.SimpleQueue[int]()
    settings = Settings("bea", endpoint, "ana" if account is None else account.name, account=account)
    door = login or PinLogin(pin, only)
    served = server.serve(settings, 0, login=door, lan=pin is not None, ready=ports.put, shutdown=shutdown)
    thread = threading.Thread(target=asyncio.run, args=(served,))
    thread.start()
    try:
        yield ports.get(timeout=EVENT_S)
    finally:
        shutdown.request()
        thread.join(EVENT_S)


def online(view: dict[str, Any]) -> bool:
    """Return whether a view shows a robot that is online."""
    return any(pill["condition"] != "absent" for pill in view["pills"])


class WebSocket:
    """One web socket; it is read only while a test waits for a message."""

    def __init__(self, browser: WebClient, path: str, headers: dict[str, str]) -> None:
        self._do = browser.do
        self.view: dict[str, Any] = {}
        self.poses: list[bytes] = []
        """messages of poses that arrived while a test waited for a view"""
        self._closed = False
        request = HTTPRequest(f"ws://127.0.0.1:{browser.port}{path}", headers=headers)
        self._socket = self._do(lambda: websocket_connect(request))

    def send(self, do: str, **fields: object) -> None:
        """Send a message of the page."""
        self.send_raw(json.dumps({"do": do, **fields}))

    def send_raw(self, text: str) -> None:
        """Send any text."""
        self._do(lambda: self._socket.write_message(text))

    def read(self) -> str | bytes | None:
        """Return the next message; None if the web socket is closed."""
        message = None
        if not self._closed:
            message = self._do(lambda: asyncio.wait_for(self._socket.read_message(), PATIENCE_S))
            self._closed = message is None
        return message

    def state(
        self, holds: Callable[[dict[str, Any]], bool], what: str, heartbeat: bool = True
    ) -> dict[str, Any]:
        """Return the next view that fulfils `holds`, with all its parts; confirm each message, as the page does.

        With `heartbeat`, also send the heartbeat of a page that drives or waits.
        """

        def look() -> bool:
            text = self.read()
            assert text is not None, f"closed ({self.code}): {what}"
            if isinstance(text, bytes):
                self.poses.append(text)
                return False
            self.view |= json.loads(text)
            self.send("seen")
            if heartbeat and self.view["you"]["drives"]:
                self.send("beat")
            return holds(self.view)

        try:
            until(look, what)
        except AssertionError as error:
            error.add_note(
                f"The page shows: {[self.view.get(part) for part in ('you', 'last', 'banner', 'pills')]}"
            )
            raise
        return self.view

    def drive(self, name: str) -> Self:
        """Take the robot under this name, and wait until this page holds it."""
        self.state(online, "a robot")
        self.send("drive", name=name)
        self.state(lambda view: any("yours" in pill["notes"] for pill in view["pills"]), f"{name} drives")
        return self

    @property
    def code(self) -> int | None:
        """The code with which the server has closed the web socket."""
        return self._socket.close_code

    def close(self) -> None:
        """Close the web socket, and read the messages that have arrived."""

        async def close() -> None:  # in the loop of this socket
            self._socket.close()

        self._do(close)
        while self.read() is not None:
            pass


class WebClient:
    """A browser without a page: it keeps cookies, and sends the given headers."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.cookies: dict[str, str] = {}
        self.token = ""
        self._runner = asyncio.Runner()
        self._sockets: list[WebSocket] = []

    def do(self, work: Callable[[], Awaitable[T]]) -> T:
        """Run a coroutine to its end."""

        async def run() -> T:
            return await work()

        return self._runner.run(run())

    def headers(self, **more: str) -> dict[str, str]:
        """Return the headers of requests of the control page, changed by `more`; an empty value omits a header."""
        own = {
            "Host": f"127.0.0.1:{self.port}",
            "Origin": f"http://127.0.0.1:{self.port}",
            "Cookie": "; ".join(f"{name}={value}" for name, value in self.cookies.items()),
            "X-XSRFToken": self.token,
        }
        return {name: value for name, value in {**own, **more}.items() if value}

    def fetch(
        self, path: str, body: str | bytes | None = None, method: str = "", **headers: str
    ) -> HTTPResponse:
        """Return the response to GET, to POST with a body, or to another method; store cookies, and follow no redirection."""

        async def ask() -> HTTPResponse:
            request = HTTPRequest(
                f"http://127.0.0.1:{self.port}{path}",
                method=method or ("GET" if body is None else "POST"),
                headers=self.headers(**headers),
                body=body,
                follow_redirects=False,
            )
            client = SimpleAsyncHTTPClient(force_instance=True)
            try:
                return await client.fetch(request, raise_error=False)
            finally:
                client.close()

        response = self.do(ask)
        for cookie in response.headers.get_list("Set-Cookie"):
            self.cookies |= {name: part.value for name, part in SimpleCookie(cookie).items()}
        return response

    def load(self) -> str:
        """Return the page after at most one redirection, and store its token for later requests."""
        response = self.fetch("/")
        if response.code == 303:
            response = self.fetch("/")
        page = response.body.decode()
        found = re.search(r'(?:name="token" content|name="_xsrf" value)="([^"]+)"', page)
        self.token = found[1] if found else ""
        return page

    def log_in(self, pin: str) -> HTTPResponse:
        """Send a PIN; return the response."""
        return self.fetch("/", f"typed={pin}")

    def connect(self, path: str = "/live", **headers: str) -> WebSocket:
        """Open a web socket; see `refusal` for one that is refused."""
        socket = WebSocket(self, path, self.headers(**headers))
        self._sockets.append(socket)
        return socket

    def refusal(self, path: str = "/live", **headers: str) -> tuple[int, str]:
        """Return status code and text of the refusal of a web socket."""
        response = self.fetch(
            path,
            **{
                "Upgrade": "websocket",
                "Connection": "Upgrade",
                "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
                "Sec-WebSocket-Version": "13",
                **headers,
            },
        )
        return response.code, response.body.decode()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        for socket in self._sockets:
            socket.close()
        self._runner.close()
