"""What all pages share: the link that watches all robots, one driver for each seat, STOP, pictures.

The methods of `Hub` run on the thread of the server's loop.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final, Protocol

from beatrix_zenoh import threads
from beatrix_zenoh.client import CameraImage, Client
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.stopping import GROUP_S, StopSender
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Source
from beatrix_zenoh.settings import Settings
from gui.console.link import Link
from gui.console.link.governing import ClassStates
from gui.console.link.pictures import CameraStream, Level, LevelStream
from gui.console.link.stopping import send_stop
from gui.console.state.actions import SendStop
from gui.page.face import Driver, Face
from gui.page.protection import Visitor

DEAD_MAN_S: Final = 0.4
"""Longest time without a heartbeat of the page; then a moving robot is stopped. Pages send ten heartbeats a second."""
GONE_S: Final = 5.0
"""Longest time without a heartbeat of a page that drives; then the server gives the robot back."""
CLOSE_S: Final = 3.5
"""Time for links and subscriptions to close."""

Camera = tuple[str, str, str]
"""Robot, side and eye."""


class OpenPage(Protocol):
    """The web socket of an open page."""

    visitor_of_page: Visitor
    face: Face

    def close(self) -> None:
        """Close the web socket of the page."""


class PictureSocket(Protocol):
    """A web socket for pictures."""

    def changed(self, camera: Camera) -> None:
        """Send the newest picture of a camera, if the browser has drawn the last one."""


class Hub:
    """Gives pages the states of robots, and links with which they drive."""

    def __init__(self, settings: Settings, only: str | None, call: Callable[..., None]) -> None:
        """Begin to watch the robots.

        Args:
            settings: router and seat.
            only: name of the only robot that pages may use; None: all robots at the router.
            call: runs a function with its arguments on the server's loop; any thread may use it.

        Raises:
            NoAnswer: NO_ROUTER.
        """
        Client(settings, announce=False).close()  # to find out whether a router answers
        self.settings, self._only, self._call = settings, only, call
        self._link = Link(settings, lambda _: None, lambda _, __: None, source=Source.PAGE)
        self._link.start()
        self.pages: set[OpenPage] = set()
        self._class = ClassStates()
        self._class.watch(on=True)
        self._stop_sender = StopSender("web")
        self._closing: list[threading.Thread] = []
        self._eyes: dict[Camera, tuple[CameraStream, set[PictureSocket]]] = {}
        self._newest: dict[Camera, CameraImage] = {}
        self._levels: dict[Place, LevelStream] = {}

    # -- views ---------------------------------------------------------------------------------------

    def robots(self) -> tuple[str, ...]:
        """Return the names of the robots that pages may use."""
        session = self._link.session
        present = () if session is None else sorted({name for name, _ in session.monitor.present()})
        return tuple(name for name in present if self._only in (None, name))

    def new_face(self, send: Callable[[bytes], None]) -> Face:
        """Return the face of a new page, which shows the first robot."""
        robots = self.robots()
        robot = next(iter(robots), self._only or self.settings.robot)
        face = Face(self._link.world(robot), send, self._stop)
        face.found = bool(robots)
        return face

    def show(self) -> None:
        """Send all pages what has changed."""
        robots = self.robots()
        for page in self.pages if robots else ():
            if not page.face.found:
                page.face.found = True
                self.watch(page, robots[0])
        shown = any(page.face.shows_class for page in self.pages)
        states = self._class.states(self._link.session, time.monotonic()) if shown else ()
        watched = {page.face.robot for page in self.pages if page.face.driver is None}
        worlds = {robot: self._link.world(robot) for robot in watched}
        self._listen()
        for page in list(self.pages):
            face = page.face
            try:
                world = worlds[face.robot] if face.driver is None else face.driver.link.world()
                world = replace(
                    world, robots=states if face.shows_class else (), levels=self._levels_of(face.robot)
                )
                face.show(world, robots)
            except Exception as error:  # noqa: BLE001 - a fault of one page must not freeze the others
                threads.show_error(error)
                page.close()

    def _listen(self) -> None:
        """Switch on exactly the microphones whose levels a page shows."""
        session = self._link.session
        listening = {page.face.robot for page in self.pages if page.face.state.choices.microphones}
        present = set() if session is None else set(session.monitor.present())
        wanted = {place for place in present if place[0] in listening}
        for place in self._levels.keys() - wanted:
            self._close_later(self._levels.pop(place).end)
        if session is not None:
            for place in wanted - self._levels.keys():
                self._levels[place] = LevelStream(session.client, place)

    def _levels_of(self, robot: str) -> dict[str, Level]:
        """Return the levels of one robot by side."""
        found = {side: stream.level for (name, side), stream in self._levels.items() if name == robot}
        return {side: level for side, level in found.items() if level is not None}

    def watch(self, page: OpenPage, robot: str) -> None:
        """Show another robot to a page, and end its driver of the former robot."""
        face = page.face
        if robot not in self.robots() or robot == face.robot:
            return
        self.end_driver(face)
        face.change(self._link.world(robot))

    # -- driving -------------------------------------------------------------------------------------

    def drive(self, page: OpenPage, name: str) -> None:
        """Open a link that takes a page's robot or waits for it; its seat is the account's or is made of `name`."""
        face, session, account = page.face, self._link.session, self.settings.account
        if face.driver is not None or session is None:
            return
        given = f"web-{names.tidy(name, page.visitor_of_page.name)}"[:32].strip("-")
        seat = given if account is None else self.settings.who
        drivers = (page.face.driver for page in self.pages if page.face.driver is not None)
        if any((driver.robot, driver.seat) == (face.robot, seat) for driver in drivers):
            key = "page.name_in_use" if account is None else "page.seat_in_use"
            face.notify(key, robot=face.robot, seat=seat)
            return
        settings = Settings(face.robot, self.settings.connect, seat, account=account)
        link = Link(
            settings, partial(self._call, face.report), lambda _, __: None, source=Source.PAGE, shared=session
        )
        link.start()
        face.notify("")
        face.driver = Driver(link, face.robot, seat, time.monotonic())

    def end_driver(self, face: Face, key: str = "") -> None:
        """Close the link of a page, so that its robot stops and is free; the page shows the text `key` as the reason."""
        driver, face.driver = face.driver, None
        if driver is None:
            return
        driver.link.jogging.end(stopped=True)
        self._close_later(driver.link.close)
        face.state.leave()
        face.notify(key)

    def check_heartbeats(self) -> None:
        """Stop moving robots whose page is silent; give a robot back if its page is silent for longer than GONE_S."""
        for page in list(self.pages):
            driver = page.face.driver
            if driver is None:
                continue
            silent_s = time.monotonic() - driver.beat_s
            if silent_s > GONE_S:
                self.end_driver(page.face, "page.gone")
            elif silent_s > DEAD_MAN_S and driver.link.busy and not driver.stopped:
                page.face.stop_moving()
                page.face.notify("page.silent")

    # -- STOP ----------------------------------------------------------------------------------------

    def _stop(self, face: Face, action: SendStop) -> None:
        """Send STOP through the session that watches, for a page that does not drive or has lost its own session."""
        session = self._link.session
        if session is not None:
            session = replace(session, twin=Twin(face.robot, client=session.client))
            send_stop(self._stop_sender, session, action, partial(self._call, face.report))

    def stop(self, visitor: Visitor, robot: str, stop: str, page: OpenPage | None = None) -> None:
        """Send STOP to simulation and hardware of a name, for any page; ignore it if its number `stop` came before.

        Other pages that drive this robot drop what waits to be sent. Without a page, one of this browser that shows the
        robot reports the outcome; without such a page, no page does.
        """
        if not names.PATTERN.fullmatch(robot) or not visitor.is_new_stop(stop):
            return
        own = [one for one in self.pages if one.visitor_of_page is visitor and one.face.robot == robot]
        page = page or next(iter(sorted(own, key=lambda one: one.face.driver is None)), None)
        for other in self.pages:
            if other is not page and other.face.robot == robot:
                other.face.drop()
        session = self._link.session
        if page is not None:
            page.face.stop()
        elif session is not None:
            self._stop_sender.send([session.client], [(robot, "*")], lambda _: None)

    # -- pictures ------------------------------------------------------------------------------------

    def start_pictures(self, socket: PictureSocket, place: Place) -> list[Camera]:
        """Begin to send pictures to a web socket; cameras work only while a page shows them. Returns both cameras."""
        session, cameras = self._link.session, [(*place, eye) for eye in names.EYES]
        if session is None or place not in session.monitor.present() or place[0] not in self.robots():
            return []
        for camera in cameras:
            if camera not in self._eyes:

                def arrived(_: str, image: CameraImage, camera: Camera = camera) -> None:
                    self._newest[camera] = image
                    self._call(self._picture, camera)

                self._eyes[camera] = CameraStream(session.client, camera, arrived), set()
            self._eyes[camera][1].add(socket)
        return cameras

    def _picture(self, camera: Camera) -> None:
        for socket in list(self._eyes[camera][1]) if camera in self._eyes else []:
            socket.changed(camera)

    def newest(self, camera: Camera) -> CameraImage | None:
        """Return the newest picture of a camera; None if none has arrived."""
        return self._newest.get(camera)

    def end_pictures(self, socket: PictureSocket) -> None:
        """Send no more pictures to a web socket; end subscriptions that no other one needs."""
        for camera, (stream, sockets) in list(self._eyes.items()):
            sockets.discard(socket)
            if not sockets:
                del self._eyes[camera]
                self._newest.pop(camera, None)
                self._close_later(stream.end)

    def _close_later(self, close: Callable[[], None]) -> None:
        """Close a link or a subscription on a thread, because it may wait for the router."""
        self._closing = [thread for thread in self._closing if thread.is_alive()]
        self._closing.append(threads.start(close, "web-close"))

    def close(self) -> None:
        """Stop the robots that pages move, and end all sessions and threads."""
        for page in list(self.pages):
            self.end_driver(page.face)
        while self._levels:
            self._close_later(self._levels.popitem()[1].end)
        for camera in list(self._eyes):
            self._close_later(self._eyes.pop(camera)[0].end)
        self._stop_sender.close()
        self._stop_sender.join(time.monotonic() + GROUP_S)
        deadline_s = time.monotonic() + CLOSE_S
        for thread in self._closing:
            thread.join(max(0.0, deadline_s - time.monotonic()))
        self._link.close()
