"""A real browser without a screen, controlled over Chrome's DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import json
import shutil
import subprocess
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, Self, TypeVar

import pytest
from robots import START_S, until
from tornado.websocket import websocket_connect

T = TypeVar("T")
PROGRAM = "chromium"
OPTIONS = (
    "--headless=new",
    "--no-sandbox",  # tests may run as root
    "--disable-dev-shm-usage",
    "--disable-gpu",
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-breakpad",
    "--no-proxy-server",
    "--remote-debugging-port=0",
)
LONGEST = 50_000_000
"""Largest message from the browser (bytes): a picture of the page."""
KEYS = {" ": 32, "Enter": 13, "Escape": 27, "ArrowLeft": 37}
"""Keys, with the codes that some libraries still read."""


class Browser:
    """Chromium with one page."""

    def __init__(self, folder: Path, size: tuple[int, int] = (1366, 768)) -> None:
        if shutil.which(PROGRAM) is None:
            pytest.fail(f"{PROGRAM} is missing: sudo apt install {PROGRAM}", pytrace=False)
        self._process = subprocess.Popen(
            [PROGRAM, *OPTIONS, f"--user-data-dir={folder}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._runner = asyncio.Runner()
        self._number = 0
        self.events: list[dict[str, Any]] = []
        found = folder / "DevToolsActivePort"
        until(lambda: found.exists() and found.read_text().count("\n") == 1, "the browser runs", START_S)
        port, path = found.read_text().split("\n")
        address = f"ws://127.0.0.1:{port}{path}"
        self._socket = self._do(lambda: websocket_connect(address, max_message_size=LONGEST))
        (page,) = (
            target for target in self.call("Target.getTargets")["targetInfos"] if target["type"] == "page"
        )
        attached = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.resize(*size)

    _session: str | None = None

    def _do(self, work: Callable[[], Awaitable[T]]) -> T:
        async def run() -> T:
            return await work()

        return self._runner.run(run())

    def call(self, method: str, **parameters: object) -> dict[str, Any]:
        """Send a command of the protocol and return its result."""
        self._number += 1
        command: dict[str, object] = {"id": self._number, "method": method, "params": parameters}
        if self._session is not None:
            command["sessionId"] = self._session

        async def ask() -> dict[str, Any]:
            await self._socket.write_message(json.dumps(command))
            while True:
                text = await asyncio.wait_for(self._socket.read_message(), START_S)
                assert text is not None, "the browser has ended"
                message: dict[str, Any] = json.loads(text)
                if message.get("id") == self._number:
                    assert "error" not in message, message
                    result: dict[str, Any] = message["result"]
                    return result
                self.events.append(message)

        return self._do(ask)

    def resize(self, width: int, height: int, *, touch: bool = False) -> None:
        """Set the size of the page, in CSS pixels."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=touch,
        )

    def pretend_graphics_chip(self) -> None:
        """Let pages that are opened later take the processor for a graphics chip."""
        script = "WebGLRenderingContext.prototype.getExtension = () => null"
        self.call("Page.addScriptToEvaluateOnNewDocument", source=script)

    def open(self, address: str) -> None:
        """Load a page, and wait until it is complete."""
        self.call("Page.navigate", url=address)
        loaded = f"location.href === {json.dumps(address)} && document.readyState === 'complete'"
        self.wait(lambda: bool(self.run(loaded)), "the page is loaded")

    def run(self, script: str) -> Any:
        """Return the value of a JavaScript expression."""
        done = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in done, done
        return done["result"].get("value")

    def text(self, selector: str) -> str:
        """Return the text of an element; empty if there is no such element."""
        found: str = self.run(f"document.querySelector({json.dumps(selector)})?.textContent ?? ''")
        return found

    def wait(self, holds: Callable[[], bool], what: str) -> None:
        """Wait until a condition holds; the AssertionError contains the page's text and errors."""
        try:
            until(holds, what, START_S)
        except AssertionError as error:
            raise AssertionError(f"{error}: {self.run('document.body.innerText')} {self.errors()}") from None

    def press(self, selector: str) -> None:
        """Press the mouse button on an element, and hold it."""
        self._mouse(selector, "mousePressed")

    def release(self, selector: str) -> None:
        """Release the mouse button on an element."""
        self._mouse(selector, "mouseReleased")

    def click(self, selector: str) -> None:
        """Click an element where it is now, even if it moves meanwhile."""
        self._mouse(selector, "mousePressed", "mouseReleased")

    def drag(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """Press the mouse button at a point (CSS pixels), move to another one, and release it."""
        ways = [
            ("mousePressed", 0.0),
            *(("mouseMoved", part) for part in (0.2, 0.6, 1.0)),
            ("mouseReleased", 1.0),
        ]
        for kind, part in ways:
            x, y = (one + part * (other - one) for one, other in zip(begin, end, strict=True))
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)

    def _mouse(self, selector: str, *kinds: str) -> None:
        x, y = self._still(selector)
        for kind in kinds:
            self.mouse(kind, x, y)

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Send an event of the left button at a place of the screen (CSS pixels)."""
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def _still(self, selector: str) -> tuple[float, float]:
        """Return the middle of an element (CSS pixels), once it keeps its place from one frame to the next."""
        find = f"document.querySelector({json.dumps(selector)})"
        x, y = self.run(f"""new Promise((resolve) => {{
            {find}.scrollIntoView({{ block: "center" }});
            let last = "";
            const look = () => {{
                const {{ x, y, width, height }} = {find}.getBoundingClientRect();
                const now = [x, y, width, height].join();
                if (now === last) resolve([x + width / 2, y + height / 2]);
                else {{ last = now; requestAnimationFrame(look); }}
            }};
            look();
        }})""")
        return x, y

    def key(self, key: str) -> None:
        """Press and release a key."""
        for kind in ("rawKeyDown", "keyUp"):
            code = key.replace(" ", "Space")
            self.call(
                "Input.dispatchKeyEvent", type=kind, key=key, code=code, windowsVirtualKeyCode=KEYS[key]
            )

    def type(self, text: str) -> None:
        """Type a text into the element that has the focus."""
        self.call("Input.insertText", text=text)

    def picture(self, path: Path) -> None:
        """Write a picture of the visible part of the page, as PNG."""
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    def errors(self) -> list[str]:
        """Return the exceptions and logged errors of the page, as JSON."""
        return [
            json.dumps(event["params"])
            for event in self.events
            if event["method"] == "Runtime.exceptionThrown"
            or (event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] == "error")
        ]

    def close(self) -> None:
        """End the browser."""
        self._session = None
        self.call("Browser.close")
        self._process.wait(START_S)

        async def end() -> None:
            while await asyncio.wait_for(self._socket.read_message(), START_S) is not None:
                pass  # read until the browser closes the connection
            self._socket.close()

        self._do(end)
        self._runner.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
