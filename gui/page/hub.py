"""The state that all pages share: session, robots, drivers, pictures.

The methods of `Hub` run on the thread of the server's loop.
"""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable, Iterable
from typing import Final, Protocol

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.client import Client, Monitor, Presence
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.stopping import GROUP_S, IF_IT_MOVES, Answers, StopSender, sentence
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.settings import Settings
from gui.page import driving, view
from gui.page.driving import DEAD_MAN_S, Driver
from gui.page.eyes import Camera, Eye
from gui.page.messages import Outcome, refused
from gui.page.protection import Visitor

GONE_S: Final = 5.0
"""Longest time without a heartbeat of a page that drives; then the server gives the robot back."""
CLOSE_S: Final = 3.0
"""Time for sessions and subscriptions to close."""
SILENT: Final = "No heartbeat came from this page, so the robot was stopped. Hold a button again to continue."
GONE: Final = "This page was silent for too long, so the robot was given back. Press Drive to take it again."
TAKEN: Final = "The robot was handed over to {holder}. Press Drive to take it again."
ENDED: Final = (
    "The robot or the router was started again, so no page drives. Press Drive to take the robot again."
)
NAME_IN_USE: Final = (
    "Another page drives {robot} as {seat}, or waits for it. Type another name, then press Drive."
)
SEAT_IN_USE: Final = "All pages of this server use the seat {seat} of its account, and one of them drives {robot}. Wait until it is given back."
NOT_DRIVING: Final = "You only watch this robot: press Drive first."
NOT_STOPPED: Final = f"STOP was sent, but no robot {{robot}} answered. {IF_IT_MOVES}"
NO_ROBOT: Final = "There is no robot {name} at the router. Choose one from the list."


class Page(Protocol):
    """A page that is open in a browser."""

    visitor_of_page: Visitor
    place: Place | None
    driver: Driver | None

    def report(self, outcome: Outcome) -> None:
        """Show the outcome of a request beside the control that sent the request."""

    def show(self, state: bytes) -> None:
        """Show a state, unless too many earlier ones are unconfirmed."""

    def close(self) -> None:
        """Close the web socket of the page."""


class PictureSocket(Protocol):
    """A web socket for pictures."""

    def changed(self, camera: Camera) -> None:
        """Send the newest picture of a camera, if the browser has drawn the last one."""


class Hub:
    """Passes requests of pages to robots, and the states of robots to pages."""

    def __init__(self, settings: Settings, only: str | None, call: Callable[..., object]) -> None:
        """Open the session and monitor the robots.

        Args:
            settings: router and seat.
            only: name of the only robot that pages may use; None: all robots at the router.
            call: runs a function with its arguments on the server's loop; any thread may use it.

        Raises:
            NoAnswer: NO_ROUTER.
        """
        self.settings, self._only, self._call = settings, only, call
        self.client = Client(settings)
        self.monitor = Monitor(self.client)
        self._router = True
        self.client.bus.watch_router(lambda there: self._set_router(there=there))
        self.pages: set[Page] = set()
        self._stop_sender = StopSender("web")
        self._closing: list[threading.Thread] = []
        self._eyes: dict[Camera, tuple[Eye, set[PictureSocket]]] = {}

    def _set_router(self, *, there: bool) -> None:
        self._router = there

    def drivers(self) -> Iterable[Driver]:
        """Return the drivers of all pages that drive or wait."""
        return [page.driver for page in self.pages if page.driver is not None]

    # -- states --------------------------------------------------------------------------------------

    def places(self) -> list[Place]:
        """Return the robots that pages may use, the simulation of each name first."""
        found = {
            (robot.robot, robot.side): robot.presence is not Presence.ABSENT
            for robot in self.monitor.robots()
            if self._only in (None, robot.robot)
        }
        return [place for place, present in found.items() if present]

    def show(self) -> None:
        """Send each page the state of its robot, and end drivers whose lease has ended."""
        if not self.pages:
            return
        places = self.places()
        listed = [{"robot": robot, "side": side} for robot, side in places]
        states = {page.place: page.place and self.monitor.robot(*page.place) for page in self.pages}
        shown = {place: state and view.state_of(state) for place, state in states.items()}
        for page in list(self.pages):
            if page.place is None and places:
                page.place = places[0]  # its state follows with the next call
            state = states.get(page.place)
            if page.driver is not None and state is not None and state.status is not None:
                status = state.status
                if page.driver.lost(status.lease, status.holder):
                    self.end_driver(page, TAKEN.format(holder=status.holder) if status.holder else ENDED)
            driver = page.driver
            content = {
                "kind": "state",
                "router": self._router,
                "robots": listed,
                "robot": shown.get(page.place),
                "you": {
                    "seat": "" if driver is None else driver.seat,
                    "drives": driver is not None and bool(driver.lease),
                    "waits": driver is not None and not driver.lease,
                },
            }
            page.show(msgspec.json.encode(content))

    def watch(self, page: Page, place: Place) -> None:
        """Show another robot to a page, and end its driver of the former robot."""
        if place not in self.places():
            page.report(refused("robot", NO_ROBOT.format(name=names.tidy(place[0]))))
        elif place != page.place:
            self.end_driver(page)
            page.place = place

    # -- driving -------------------------------------------------------------------------------------

    def drive(self, page: Page, name: str) -> None:
        """Start a driver that takes a page's robot or waits for it; its seat is the account's or is made of `name`."""
        if page.driver is not None or page.place is None:
            return
        account = self.settings.account
        seat = self.settings.who if account is not None else self._seat(page, name)
        robot = page.place[0]
        if any((driver.place, driver.seat) == (page.place, seat) for driver in self.drivers()):
            text = NAME_IN_USE if account is None else SEAT_IN_USE
            page.report(refused("drive", text.format(robot=robot, seat=seat)))
            return
        settings = Settings(robot, self.settings.connect, seat, account=account)
        driver: Driver

        def ended(text: str) -> None:
            self._call(lambda: self.end_driver(page, text) if page.driver is driver else None)

        driver = page.driver = Driver(settings, page.place, self._reporter(page), ended)

    def _seat(self, page: Page, name: str) -> str:
        """Return a seat made of the typed name, or of a guest name if that has neither letters a-z nor digits."""
        used = {driver.seat for driver in self.drivers()}
        guest = page.visitor_of_page.name
        guests = itertools.chain([guest], (f"{guest}-{number}" for number in itertools.count(2)))
        free = next(guest for guest in guests if f"web-{guest}" not in used)
        return f"web-{names.tidy(name, free)}"[:32].strip("-")

    def end_driver(self, page: Page, text: str = "") -> None:
        """End the driver of a page, so that its robot stops and is free; the page shows `text` as the reason."""
        driver, page.driver = page.driver, None
        if driver is None:
            return
        driver.drop()
        self._close_later(driver.close)
        if text:
            page.report(refused("drive", text))

    def driver_of(self, page: Page, control: str) -> Driver | None:
        """Return the driver of a page that drives; otherwise report to the page that it must drive first."""
        driver = page.driver
        if driver is None or not driver.lease:
            page.report(refused(control, NOT_DRIVING))
            return None
        return driver

    def check_heartbeats(self) -> None:
        """Stop moving robots whose page is silent; give a robot back if its page is silent for longer than GONE_S."""
        for page in list(self.pages):
            driver = page.driver
            if driver is None:
                continue
            silent_s = driver.silent()
            if silent_s > GONE_S:
                self.end_driver(page, GONE)
            elif silent_s > DEAD_MAN_S and driver.busy and not driver.stopped:
                self.stop_driver(driver, page)
                page.report(refused("drive", SILENT))

    def hidden(self, page: Page) -> None:
        """Stop the robot of a page that is no longer visible, if it moves for this page."""
        if page.driver is not None and page.driver.busy:
            self.stop_driver(page.driver, page)

    def stop_driver(self, driver: Driver, page: Page) -> None:
        """Stop the robot of one page, because the page is silent or hidden."""
        driver.stopped = True
        driver.drop()
        self._send_stop(driver.place[0], driver, self._reporter(page))

    # -- STOP ----------------------------------------------------------------------------------------

    def stop(self, visitor: Visitor, robot: str, stop: str, page: Page | None) -> None:
        """Send STOP to simulation and hardware of a name, for any page; ignore it if its number `stop` came before."""
        if not names.PATTERN.fullmatch(robot) or not visitor.is_new_stop(stop):
            return
        own = None
        for driver in self.drivers():
            if driver.place[0] == robot:
                driver.drop()
        pages = [other for other in self.pages if other.visitor_of_page is visitor]
        for other in pages:
            if other.driver is not None and other.driver.place[0] == robot:
                own = other.driver
        self._send_stop(robot, own, self._reporter(*(pages if page is None else [page])))

    def _send_stop(self, robot: str, driver: Driver | None, report: driving.Report) -> None:
        """Send STOP through the session of a driver, so that its seat need not pause; otherwise through the hub's."""

        def answered(answers: Answers) -> None:
            for place, answer in answers.items():
                ok, text = not isinstance(answer, BeatrixError), sentence(place, answer.message)
                report(Outcome("stop", ok=ok, text=text))
            if not answers:
                report(refused("stop", NOT_STOPPED.format(robot=robot)))

        own = None if driver is None else driver.client
        clients = [self.client] if own is None else [own, self.client]
        self._stop_sender.send(clients, [(robot, "*")], answered, self.monitor.present())

    def _reporter(self, *pages: Page) -> driving.Report:
        """Return a function that reports to pages; any thread may call it."""

        def report(outcome: Outcome) -> None:
            for page in pages:
                self._call(page.report, outcome)

        return report

    # -- pictures ------------------------------------------------------------------------------------

    def start_pictures(self, socket: PictureSocket, cameras: Iterable[Camera]) -> None:
        """Begin to send pictures to a web socket; cameras work only while a page shows them."""
        for camera in cameras:
            if camera not in self._eyes:
                eye = Eye(self.client, camera, lambda changed: self._call(self._picture, changed))
                self._eyes[camera] = eye, set()
            self._eyes[camera][1].add(socket)

    def _picture(self, camera: Camera) -> None:
        for socket in list(self._eyes[camera][1]) if camera in self._eyes else []:
            socket.changed(camera)

    def newest(self, camera: Camera) -> tuple[int, bytes] | None:
        """Return number and JPEG of the newest picture of a camera; None if none has arrived."""
        picture = self._eyes[camera][0].newest if camera in self._eyes else None
        return None if picture is None else (picture.seq, picture.jpeg)

    def end_pictures(self, socket: PictureSocket) -> None:
        """Send no more pictures to a web socket; end subscriptions that no other one needs."""
        for camera, (eye, sockets) in list(self._eyes.items()):
            sockets.discard(socket)
            if not sockets:
                del self._eyes[camera]
                self._close_later(eye.end)

    def _close_later(self, close: Callable[[], None]) -> None:
        """Close a session or a subscription on a thread, because it may wait for the router."""
        self._closing = [thread for thread in self._closing if thread.is_alive()]
        self._closing.append(threads.start(close, "web-close"))

    def close(self) -> None:
        """Stop the robots that pages move, and end all sessions and threads."""
        for page in list(self.pages):
            self.end_driver(page)
        for camera in list(self._eyes):
            self._close_later(self._eyes.pop(camera)[0].end)
        self._stop_sender.close()
        self._stop_sender.join(time.monotonic() + GROUP_S)
        deadline_s = time.monotonic() + CLOSE_S
        for thread in self._closing:
            thread.join(max(0.0, deadline_s - time.monotonic()))
        self.client.close()
