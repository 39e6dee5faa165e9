"""What all pages share: the link that watches all robots, and one driver for each seat.

The methods of `Hub` run on the thread of the server's loop.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Positions, Source
from beatrix_zenoh.settings import Settings
from gui.console.link import Link
from gui.console.link.governing import robots_online
from gui.console.link.jobs import Jobs
from gui.console.state.actions import ChooseRobot
from gui.console.state.arms import Steer
from gui.console.state.gestures import RunExample
from gui.page.eyes import Eyes
from gui.page.face import Driver, Face
from gui.page.lessons_face import Lessons
from gui.page.poses import Poses
from gui.page.protection import Login
from gui.page.shelf import Desk, Shelf
from gui.page.stops import Stops

DEAD_MAN_S: Final = 0.4
"""Longest time without a heartbeat of the page; then a moving robot is stopped. Pages send ten heartbeats a second."""
GONE_S: Final = 5.0
"""Longest time without a heartbeat of a page that drives; then the server gives the robot back."""
OVERRIDE_S: Final = 1.0
"""Time at rest after which the stick of a teacher gives the robot back (s)."""
PROGRAMS_MAX: Final = 4
"""Largest number of pages for which *Follow* or *Listen* runs: each is a process of its own on this computer."""
CLOSE_S: Final = 3.5
"""Time for links and subscriptions to close."""


class Hub:
    """Gives pages the states of robots, and links with which they drive."""

    def __init__(self, settings: Settings, login: Login, call: Callable[..., None], shelf: Shelf) -> None:
        """Begin to watch the robots.

        Args:
            settings: router and seat of the server.
            login: the browsers, their robots and accounts.
            call: runs a function with its arguments on the server's loop; any thread may use it.
            shelf: the programs of all seats.

        Raises:
            NoAnswer: NO_ROUTER.
        """
        Client(settings, announce=False).close()  # to find out whether a router answers
        self.settings, self.login, self._call, self._shelf = settings, login, call, shelf
        self._link = Link(settings, lambda _: None, lambda _, __: None, source=Source.PAGE)
        self.pages: set[Face] = set()
        self.poses = Poses(self._positions)
        self._jobs = Jobs("web")
        self._closing: list[threading.Thread] = []
        """threads that close the links of pages"""
        self.stops = Stops(lambda: self._link.session, login, self.pages, call)
        self.eyes = Eyes(lambda: self._link.session, self._jobs, call)
        self._link.world()  # looks for the router, and for gestures before a page shows them

    # -- views ---------------------------------------------------------------------------------------

    def robots(self, visitor: str) -> tuple[str, ...]:
        """Return the names of the robots that a browser may use."""
        return self.login.robots(visitor, self._link.names())

    def new_page(
        self,
        visitor: str,
        send: Callable[[bytes], object],
        close: Callable[[], None],
        valid: Callable[[], object] = lambda: True,
        *,
        drives: bool = True,
    ) -> Face:
        """Return the face of a new page, which shows the first of its robots; a seat of a class also drives it.

        Args:
            visitor: the name of the browser, or its seat.
            send: sends a message to the browser.
            close: closes the page's web socket.
            valid: returns a false value when the browser has to log in again.
            drives: whether a pupil's page drives at once; that of a projector only watches.
        """
        robot = next(iter(self.robots(visitor)), self.settings.robot)
        desk = Desk(self._shelf, visitor, teacher=visitor == names.TEACHER)
        lessons = Lessons(self._shelf.folder.parent / "progress" / visitor, self._call)
        face = Face(self._link.world(robot), visitor, send, close, self.stops.of_page, desk, lessons)
        face.valid, face.shown = valid, self.login.shown(visitor)
        face.shows_class = visitor == names.TEACHER
        account = self.login.account(visitor)
        if account is not None:
            face.link = self._open(face, Settings(robot, account.connect, account.name, account=account))
        if drives:
            self._drive_own(face)
        self.pages.add(face)
        return face

    def _open(self, face: Face, settings: Settings) -> Link:
        """Return a link that reports to a page; it reads the robots' states from the session that all share."""
        report, shared = partial(self._call, face.report), self._link.session
        own = (self._shelf.folder / face.visitor / "gestures",)
        link = Link(settings, report, lambda _, __: None, source=Source.PAGE, shared=shared, gestures=own)
        link.look()
        return link

    def _drive_own(self, face: Face) -> None:
        """Let a pupil's page drive its own robot without a press."""
        if face.link is not None and face.robot == face.visitor:
            self.drive(face, "")

    def remove(self, face: Face) -> None:
        """End a page whose web socket is closed: its robots stop and are free."""
        self.pages.discard(face)
        self.end_driver(face)
        if face.link is not None:
            self._close(face.link)

    def _close(self, link: Link) -> None:
        self._closing = [thread for thread in self._closing if thread.is_alive()]
        self._closing.append(threads.start(link.close, "close"))  # it may wait for the router

    async def show(self) -> None:
        """Send all pages what has changed, one after the other: requests, such as STOP, wait for one view at most."""
        self._link.look()
        session = self._link.session
        shown = any(face.shows_class for face in self.pages)
        states, present = robots_online(session) if shown else (), self._link.names()
        for face in list(self.pages):
            if session is not None and not face.due(session.monitor.changes(face.robot), time.monotonic()):
                continue
            try:
                robots = self.login.robots(face.visitor, present)
                if robots and not face.aimed and face.robot not in robots:
                    self.watch(face, robots[0])  # none was online when the page was opened
                own = face.own_link
                others = (name for name in robots if face.robot == face.visitor != name)
                face.beside = next(others, "") if face.link is not None else ""
                world = self._link.world(face.robot) if own is None else own.world()
                face.show(replace(world, robots=states if face.shows_class else ()), robots)
                if not face.valid():
                    face.close()
            except Exception as error:  # noqa: BLE001 - a fault of one page must not freeze the others
                threads.show_error(error)
                face.close()
            await asyncio.sleep(0)

    def watch(self, face: Face, robot: str) -> None:
        """Show another robot to a page, and end its driver of the former robot."""
        if robot not in self.robots(face.visitor) or robot == face.robot:
            return
        self.end_driver(face)
        if face.link is not None:
            face.link.do(ChooseRobot(robot))
        face.change(self._link.world(robot))
        self._drive_own(face)

    def _positions(self, robot: str, side: str) -> Positions | None:
        session = self._link.session
        return None if session is None else session.monitor.positions(robot, side)

    # -- driving -------------------------------------------------------------------------------------

    def drive(self, face: Face, name: str) -> None:
        """Open a link that takes a page's robot or waits for it; its seat is the account's or is made of `name`."""
        account = self.settings.account
        if face.driver is not None or (face.link is None and self._link.session is None):
            return
        given = f"web-{names.tidy(name, face.visitor)}"[:32].strip("-")
        own = face.visitor if face.link is not None else self.settings.who
        seat = given if account is None else own
        drivers = ((page, page.driver) for page in self.pages if page.robot == face.robot)
        rivals = [page for page, driver in drivers if driver is not None and driver.seat == seat]
        if (
            face.link is not None
        ):  # the newest page of a seat drives: one that was loaded again, or on another tablet
            for page in rivals:
                self.end_driver(page, "page.taken_over")
        elif rivals:
            key = "page.name_in_use" if account is None else "page.seat_in_use"
            face.notify(key, robot=face.robot, seat=seat)
            return
        settings = Settings(face.robot, self.settings.connect, seat, account=account)
        face.notify("")
        face.driver = Driver(face.link or self._open(face, settings), seat, time.monotonic())

    def end_driver(self, face: Face, key: str = "") -> None:
        """Stop the robot of a page, and give it back; the page shows the text `key` as the reason."""
        driver = face.driver
        if driver is None:
            return
        driver.link.drop()
        self._closing += face.lessons.threads
        if driver.link is face.link:
            face.give_back()
        else:
            self._close(driver.link)
        face.driver = None
        face.state.leave()
        face.notify(key)

    def steer(self, face: Face, request: Steer) -> None:
        """Turn the head by a stick or keys; a page of the teacher takes the robot for that, and gives it back at rest."""
        if face.link is not None and face.driver is None and face.visitor == names.TEACHER:
            self.drive(face, "")
            if face.driver is not None:
                face.driver.overrides = True
        driver = face.driver
        if driver is not None and driver.overrides:
            driver.steered_s = time.monotonic()
            if not face.holds:
                return  # the robots have not accepted the teacher yet
        face.carry_out(request)

    def run_example(self, face: Face, request: RunExample) -> None:
        """Run *Follow* or *Listen* for a page, unless they run for as many other pages as the computer can serve."""
        others = sum(page.runs_program for page in self.pages if page is not face)
        if face.driver is not None and others >= PROGRAMS_MAX:
            face.notify("page.programs_many", most=str(PROGRAMS_MAX))
        else:
            face.carry_out(request)

    def check_heartbeats(self) -> None:
        """Stop moving robots whose page is silent; give a robot back if its page is silent for longer than GONE_S."""
        for face in self.pages:
            driver = face.driver
            if driver is None:
                continue
            silent_s = time.monotonic() - driver.beat_s
            if silent_s > GONE_S:
                self.end_driver(face, "page.gone")
            elif driver.overrides and time.monotonic() - driver.steered_s > OVERRIDE_S:
                self.end_driver(face, "page.given_back")
            elif silent_s > DEAD_MAN_S and driver.link.moving.busy and not driver.stopped:
                face.stop_moving()
                face.notify("page.silent")

    def close(self) -> None:
        """Stop the robots that pages move, and end all sessions and threads."""
        for face in list(self.pages):
            self.remove(face)
        for part in (self.eyes, self.stops, self._jobs):
            part.close()
        deadline_s = time.monotonic() + CLOSE_S
        self.stops.join(deadline_s)
        self._jobs.join(deadline_s)
        for thread in self._closing:
            thread.join(max(0.0, deadline_s - time.monotonic()))
        self._link.close()
