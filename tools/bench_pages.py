"""Many control pages at one server: processor time of the server, STOP of pages, and a whole class with browsers.

    python tools/bench_pages.py [NUMBER ...]
    python tools/bench_pages.py class

NUMBER of pages (default: 0 1 10 30) that watch or drive 30 simulations in one process, without a browser: each page is
two messages a second to read and, if it drives, two heartbeats a second to send. STOP is measured from its message on
the page's web socket to the event that the robot publishes; the floor of this run is STOP of a program at the same
robot. `class` runs a class of 30 seats, each with an own head: 24 such pages and 6 in real browsers, 5 of them moving.
"""

from __future__ import annotations

import asyncio
import json
import re
import sys
import time
from contextlib import ExitStack
from http.cookies import SimpleCookie
from itertools import count, cycle
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from bench_node import ROOT, Served, cpu_s, free_endpoint, spread_ms
from tornado.httpclient import HTTPRequest
from tornado.ioloop import PeriodicCallback
from tornado.simple_httpclient import SimpleAsyncHTTPClient
from tornado.websocket import WebSocketClientConnection, websocket_connect

from beatrix_zenoh import account as accounts
from beatrix_zenoh import class_file, class_words
from beatrix_zenoh.classroom import provision
from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.settings import Settings

sys.path.append(str(ROOT / "tests/support"))
from browser import Browser
from robots import children

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


CLASS: Final = """name = "bench"
addresses = ["127.0.0.1"]
seats = 30
[router]
port = {port}
page = {page}
"""
MOVING, BROWSERS = 5, 6


async def move(pages: list[Page]) -> None:
    """Turn the heads of these pages to and fro until this is cancelled."""
    for yaw in cycle((25.0, -25.0)):
        for page in pages:
            page.send("AimHead", yaw=yaw, pitch=0.0, roll=0.0)
            page.send("SendHead")
        for _ in range(20):
            for page in pages:
                page.send("beat")
            await asyncio.sleep(0.1)


async def answers(page: Page) -> list[float]:
    """Return the times (s) from a change of a choice to the view that shows it."""
    took = []
    for number in range(STOPS):
        began_s = time.monotonic()
        page.send("Choose", name="speed", value=10 + number)
        while page.view["choices"]["speed"] != 10 + number:  # type: ignore[index]
            assert time.monotonic() - began_s < 5, "no view"
            await asyncio.sleep(0.001)
        took.append(time.monotonic() - began_s)
        await asyncio.sleep(0.02 + number % 7 / 100)
    return took


def used_s(served: dict[str, Served]) -> dict[str, float]:
    """Return the processor time (s) of each process with its children: the routers of a class are children."""
    return {name: one.cpu_s() + sum(map(cpu_s, children(one.pid))) for name, one in served.items()}


async def in_class(port: int, words: dict[str, str], teacher: Client, served: dict[str, Served]) -> None:
    """Open the pages, and print the figures."""
    pages = [Page(port, seat) for seat in words if seat != "teacher"][: ROBOTS - BROWSERS]
    for page in pages:
        await page.open(words[page.robot])
    beats = PeriodicCallback(lambda: beat(pages), BEAT_MS)
    beats.start()
    moving = asyncio.create_task(move(pages[:MOVING]))
    await asyncio.sleep(SETTLE_S)
    before, began_s = used_s(served), time.monotonic()
    await asyncio.sleep(LASTS_S)
    after, lasted_s = used_s(served), time.monotonic() - began_s
    for name, one in served.items():
        print(
            f"  {name}: {100 * (after[name] - before[name]) / lasted_s:.0f} % of a core, {one.rss_mib():.0f} MiB"
        )
    factors = [
        status.plant.real_time_factor
        for n in range(1, ROBOTS + 1)
        if (status := Robot(f"seat{n:02d}", "sim", client=teacher).status()).plant is not None
    ]
    print(f"  real-time factor, lowest and highest: {min(factors):.4f} {max(factors):.4f}")
    print(f"  press -> view [ms]: {spread_ms(await answers(pages[-1]))}")
    ours, floor = await stops(pages[MOVING:], teacher)
    print(f"  STOP of a page [ms]: {spread_ms(ours)}; of the teacher's program: {spread_ms(floor)}")
    moving.cancel()
    beats.stop()
    for page in pages:
        page.close()


def whole_class() -> None:
    """Run a class with pages in browsers and without, and print its figures."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        page = int(free_endpoint().rpartition(":")[2])
        file = folder / "class.toml"
        file.write_text(CLASS.format(port=page + 1, page=page), encoding="ascii")
        described = class_file.read(file)
        provision.init(described, folder / "bench")
        account = folder / "bench/seats/teacher.toml"
        words, served = class_words.read(folder / "bench").words, dict[str, Served]()
        for name, options in {
            "routers": ("router", "--class", str(file)),
            "sim": ("sim", "--seats", str(file), "--ready"),
            "page": ("web", "--class", str(file)),
        }.items():
            served[name] = Served("beatrix_zenoh.cli", *options, account=account)
            stack.callback(served[name].end)
        for number in range(ROBOTS - BROWSERS + 1, ROBOTS + 1):
            browser = stack.enter_context(Browser(folder / f"browser{number}", (820, 1180)))
            browser.call("Page.navigate", url=f"http://127.0.0.1:{page}/#{words[f'seat{number:02d}']}")
            browser.wait(lambda browser=browser: bool(browser.text("#stop")), "the page")  # type: ignore[misc]
        own = accounts.load(account)
        teacher = stack.enter_context(Client(Settings("seat01", own.connect, "teacher", account=own)))
        print(f"{ROBOTS - BROWSERS} pages and {BROWSERS} browsers, {MOVING} heads move", flush=True)
        asyncio.run(in_class(page, words, teacher, served))


def main() -> None:
    """Print a row for each number of pages."""
    if sys.argv[1:] == ["class"]:
        whole_class()
        return
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
