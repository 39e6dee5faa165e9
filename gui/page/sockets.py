"""The two web sockets of browsers: one for the requests of a page and its views, one for pictures."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final, Never

import msgspec
from tornado import websocket

from beatrix_zenoh.client import CameraImage
from gui.console.state import actions
from gui.console.state.arms import Steer
from gui.console.state.gestures import RunExample
from gui.console.state.intents import Intent, SaveGesture
from gui.console.state.own_gestures import DeleteGesture
from gui.page import messages, protection
from gui.page.eyes import Camera
from gui.page.face import Face
from gui.page.handlers import Guarded
from gui.page.hub import Hub

MESSAGES_MAX: Final = 200
"""Largest number of messages of a page in a second; a page normally sends twenty."""
TOO_FAST, MALFORMED = 4001, 4002
"""Codes with which the server closes a web socket; the page reads them."""


class Socket(Guarded, websocket.WebSocketHandler):
    """A web socket of a browser that is logged in."""

    def prepare(self) -> None:
        """Refuse browsers that are not logged in."""
        super().prepare()
        self.valid = partial(self.context.login.visitor, self.ticket)
        """returns None when the browser has to log in again"""
        if not self._finished and self.valid() is None:
            self.reject(403, protection.NO_COOKIE)

    def send(self, message: str | bytes, *, binary: bool = False) -> asyncio.Future[None] | None:
        """Send a message, unless the browser has disconnected; return what is done when it has left this computer."""
        try:
            future = self.write_message(message, binary=binary)
        except websocket.WebSocketClosedError:
            return None
        future.add_done_callback(lambda done: done.exception())  # ignores that the browser has disconnected
        return future


class Live(Socket):
    """The web socket for the requests of one page and the views that it shows."""

    def open(self, *_: str, **__: str) -> None:
        """Register the page."""
        visitor, self.hub = self.visitor, self.context.hub
        assert visitor is not None
        self._count = 0
        self._second = time.monotonic()
        self.set_nodelay(True)
        show, drives = lambda view: self.send(view.decode()), self.get_query_argument("watch", None) is None
        self.face = self.hub.new_page(visitor, show, self.close, self.valid, drives=drives)
        self.hub.poses.start(self.face, lambda pose: self.send(pose, binary=True))

    def on_close(self) -> None:
        """Remove the page and end its driver, which stops the robot."""
        self.hub.poses.end(self.face)
        self.hub.remove(self.face)

    def on_message(self, message: str | bytes) -> None:
        """Carry out a request; close the web socket after an invalid message or too many messages."""
        now_s = time.monotonic()
        if now_s - self._second >= 1.0:
            self._second, self._count = now_s, 0
        self._count += 1
        try:
            request = messages.read(message)
        except msgspec.DecodeError:
            self.close(MALFORMED, "A message of this page cannot be read: load the page again.")
            return
        if self._count <= MESSAGES_MAX or isinstance(request, messages.StopRobot):
            self.carry_out(request)
        if self._count > MESSAGES_MAX:
            self.close(TOO_FAST, "This page sends too many messages: load the page again.")

    def carry_out(self, request: messages.Request) -> None:
        """Carry out a request."""
        if self.face.driver is not None and not isinstance(request, messages.ViewReceived):
            self.face.driver.beat()
        if type(request) in HANDLES:
            HANDLES[type(request)](self.hub, self.face, request)  # type: ignore[arg-type]  # it is of this class
        elif isinstance(request, Intent):
            self.face.carry_out(request)


HANDLES: Mapping[type, Callable[[Hub, Face, Never], None]] = {
    messages.StopRobot: lambda hub, face, request: hub.stops.of_browser(
        face.visitor, request.robot, request.stop, face
    ),
    messages.ViewReceived: lambda _, face, __: face.seen(),
    messages.Open: lambda _, face, request: face.open(request.saved),
    messages.Drive: lambda hub, face, request: hub.drive(face, request.name),
    Steer: lambda hub, face, request: hub.steer(face, request),
    RunExample: lambda hub, face, request: hub.run_example(face, request),
    messages.Leave: lambda hub, face, _: hub.end_driver(face),
    messages.Hidden: lambda _, face, __: face.stop_moving(),
    messages.ShowClass: lambda _, face, request: face.show_class(on=request.on),
    messages.SaveProgram: lambda _, face, request: face.use_programs(request),
    messages.CheckProgram: lambda _, face, request: face.lessons.check(face, request),
    messages.AskHint: lambda _, face, request: face.lessons.hint(face, request),
    messages.OpenProgram: lambda _, face, request: face.use_programs(request),
    **dict.fromkeys((SaveGesture, DeleteGesture), lambda _, face, request: face.change_gestures(request)),
    actions.ChooseRobot: lambda hub, face, request: hub.watch(face, request.name),
}
"""What carries out the messages of a page; the others are heartbeats, or intents of the console."""


class Pictures(Socket):
    """The pictures of both eyes, or with `eye=left` of one: each message is the number of the eye, 0 or 1, and a JPEG file."""

    def open(self, *_: str, **__: str) -> None:
        """Begin to send pictures of the robot and side in the URL; close the web socket if that is not online."""
        place = self.get_query_argument("robot", ""), self.get_query_argument("side", "")
        self._ready = [True, True]
        self._newest: list[CameraImage | None] = [None, None]
        """the picture of each eye that was not sent yet"""
        both = self.get_query_argument("eye", "") != "left"
        hub = self.context.hub
        may = place[0] in hub.robots(self.visitor or "")
        self._cameras = hub.eyes.start(self, place, self.changed, both=both) if may else []
        if self._cameras:
            self.set_nodelay(True)
        else:
            self.close()

    def changed(self, camera: Camera, image: CameraImage) -> None:
        """Take a new picture."""
        eye = self._cameras.index(camera)
        self._newest[eye] = image
        self._send_newest(eye)

    def on_message(self, message: str | bytes) -> None:
        """Send the next picture of eye `0` or `1`, because the browser has drawn the last one."""
        if message in ("0", "1"):
            self._ready[int(message)] = True
            self._send_newest(int(message))

    def _send_newest(self, eye: int) -> None:
        if self.valid() is None:  # its word was replaced
            self.close()
            return
        image = self._newest[eye]
        if self._ready[eye] and image is not None:
            self._ready[eye], self._newest[eye] = False, None
            self.send(bytes([eye]) + image.jpeg, binary=True)

    def on_close(self) -> None:
        """Send no more pictures."""
        self.context.hub.eyes.end(self)
