"""Many control pages at one server: processor time of the server, ages of views, and STOP of a page.

    python tools/bench_pages.py [NUMBER ...]

NUMBER of pages (default: 0 1 10 30) that watch or drive 30 simulations in one process, without a browser: each page is
two messages a second to read and, if it drives, two heartbeats a second to send. STOP is measured from its message on
the page's web socket to the event that the robot publishes; the floor of this run is STOP of a program at the same
robot.
"""

from __future__ import annotations

import asyncio
import json
import re
import sys
import time
from contextlib import ExitStack
from http.cookies import SimpleCookie
from itertools import count
from typing import Final

from bench_node import Served, free_endpoint, spread_ms
from tornado.httpclient import HTTPRequest
from tornado.ioloop import PeriodicCallback
from tornado.simple_httpclient import SimpleAsyncHTTPClient
from tornado.websocket import WebSocketClientConnection, websocket_connect

from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.settings import Settings

ROBOTS: Final = 30
LASTS_S: Final = 8.0
SETTLE_S: Final = 3.0
STOPS: Final = 60
BEAT_MS: Final = 500
"""Period of the heartbeats of a page that drives and moves nothing."""
NUMBERS = (0, 1, 10, 30)


class Page:
    """A page without a browser."""

    def __init__(self, port: int, robot: str) -> None:
        self.port, self.robot = port, robot
        self.views = 0
        self.bytes = 0
        self.view: dict[str, object] = {}
        self._socket: WebSocketClientConnection

    async def open(self, word: str = "") -> None:
        """Load the page, log in with a word if the server needs one, and read its views from now on."""
        cookies: dict[str, str] = {}

        async def fetch(body: str | None = None) -> str:
            headers = {
                "Cookie": "; ".join(f"{name}={value}" for name, value in cookies.items()),
                "Origin": f"http://127.0.0.1:{self.port}",
            }
            request = HTTPRequest(
                f"http://127.0.0.1:{self.port}/",
                method="GET" if body is None else "POST",
                headers=headers,
                body=body,
                follow_redirects=False,
            )
            response = await SimpleAsyncHTTPClient(force_instance=True).fetch(request, raise_error=False)
            for cookie in response.headers.get_list("Set-Cookie"):
                cookies.update({name: part.value for name, part in SimpleCookie(cookie).items()})
            return response.body.decode()

        page = await fetch()
        if word:
            token = re.findall(r'name="_xsrf" value="([^"]+)"', page)[0]
            await fetch(f"_xsrf={token}&typed={word}")
        await fetch()
        headers = {
            "Cookie": "; ".join(f"{name}={value}" for name, value in cookies.items()),
            "Origin": f"http://127.0.0.1:{self.port}",
        }
        self._socket = await websocket_connect(
            HTTPRequest(f"ws://127.0.0.1:{self.port}/live", headers=headers)
        )
        self._reading = asyncio.create_task(self._read())
        self.send("open", saved={"language": "en"})
        self.send("ChooseRobot", name=self.robot)

    def send(self, do: str, **fields: object) -> None:
        """Send a message of the page."""
        self._socket.write_message(json.dumps({"do": do, **fields}))

    async def _read(self) -> None:
        while (message := await self._socket.read_message()) is not None:
            self.bytes += len(message)
            if isinstance(message, str):
                self.views += 1
                self.view |= json.loads(message)
                self.send("seen")

    def close(self) -> None:
        """Close the web socket."""
        self._reading.cancel()
        self._socket.close()


async def stops(pages: list[Page], client: Client) -> tuple[list[float], list[float]]:
    """Return the times (s) from STOP of pages, and of a program, to the robot's event."""
    ours: list[float] = []
    floor: list[float] = []
    numbers = count()
    for number in range(STOPS):
        page = pages[number % len(pages)]
        with (
            subscription.events(client, page.robot, "sim") as events,
            Robot(page.robot, "sim", client=client) as robot,
        ):
            for took, press in (
                (ours, lambda page=page: page.send("stop", robot=page.robot, stop=f"b{next(numbers)}")),
                (floor, lambda robot=robot: asyncio.get_running_loop().run_in_executor(None, robot.stop)),
            ):
                await asyncio.sleep(0.03 + number % 7 / 100)
                events.take()
                began_s = time.monotonic()
                press()
                while not any(event.kind is EventKind.STOP for event in events.take()):
                    assert time.monotonic() - began_s < 5, "no STOP"
                    await asyncio.sleep(0.0005)
                took.append(time.monotonic() - began_s)
    return ours, floor


def beat(pages: list[Page]) -> None:
    """Send a heartbeat of each page."""
    for page in pages:
        page.send("beat")


async def measure(number: int, port: int, endpoint: str, served: dict[str, Served], *, drive: bool) -> str:
    """Open pages, and return the row of their figures."""
    pages = [Page(port, f"seat{n % ROBOTS + 1:02d}") for n in range(number)]
    for page in pages:
        await page.open()
    beats = PeriodicCallback(lambda: beat(pages), BEAT_MS)
    if drive:
        for n, page in enumerate(pages):
            page.send("drive", name=f"b{n}")
        beats.start()
    await asyncio.sleep(SETTLE_S)
    before = {name: one.cpu_s() for name, one in served.items()}
    began_s, views, size = (
        time.monotonic(),
        sum(page.views for page in pages),
        sum(page.bytes for page in pages),
    )
    await asyncio.sleep(LASTS_S)
    lasted_s = time.monotonic() - began_s
    cpu = " ".join(
        f"{name} {100 * (one.cpu_s() - before[name]) / lasted_s:.0f}" for name, one in served.items()
    )
    rates = (
        (sum(page.views for page in pages) - views) / lasted_s,
        (sum(page.bytes for page in pages) - size) / lasted_s,
    )
    row = f"{number:3} {'drive' if drive else 'watch'}  CPU [%]: {cpu}; {rates[0]:.0f} views/s, {rates[1] / 1000:.1f} kB/s; {served['web'].rss_mib():.0f} MiB"
    if pages:
        with Client(Settings("seat01", endpoint, "bench")) as client:
            ours, floor = await stops(pages, client)
        row += f"; STOP {spread_ms(ours)}, floor {spread_ms(floor)} ms"
    beats.stop()
    for page in pages:
        page.close()
    return row


def main() -> None:
    """Print a row for each number of pages."""
    with ExitStack() as stack:
        endpoint = free_endpoint()
        port = int(free_endpoint().rpartition(":")[2])
        served = {}
        names = [word for n in range(1, ROBOTS + 1) for word in ("--name", f"seat{n:02d}")]
        for name, words in {
            "router": ("beatrix_zenoh.cli", "router", "--listen", endpoint),
            "sim": ("sim_node", *names, "--ready", "--connect", endpoint),
            "web": ("beatrix_zenoh.cli", "web", "--connect", endpoint, "--port", str(port), "--who", "web"),
        }.items():
            served[name] = Served(*words)
            stack.callback(served[name].end)
        for number in map(int, sys.argv[1:] or NUMBERS):
            for drive in (False, True)[: 1 + bool(number)]:
                print(asyncio.run(measure(number, port, endpoint, served, drive=drive)), flush=True)


if __name__ == "__main__":
    main()
