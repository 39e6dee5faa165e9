"""Requests of browsers: the page, the login, STOP, and the two web sockets."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final, Never

import msgspec
from tornado import web, websocket

from beatrix_zenoh.client import CameraImage
from gui.console.state import actions
from gui.console.state.arms import Steer
from gui.console.state.gestures import RunExample
from gui.console.state.intents import Intent, SaveGesture
from gui.console.state.own_gestures import EMOJI, DeleteGesture
from gui.console.texts import DEFAULT_LANGUAGE, LANGUAGES, Texts
from gui.page import messages, protection
from gui.page.face import Face
from gui.page.hub import Camera, Hub
from gui.page.protection import Login
from gui.page.static_files import StaticFolder

MESSAGES_MAX: Final = 200
"""Largest number of messages of a page in a second; a page normally sends twenty."""
NOTHING: Final = "This server has no such page. The control page is at /."
COOKIE_DAYS: Final = 200
"""How long a browser keeps the seat of a class."""
TOO_FAST, MALFORMED = 4001, 4002
"""Codes with which the server closes a web socket; the page reads them."""


class Context:
    """Data that all handlers share."""

    def __init__(self, hub: Hub, login: Login, cookie: str, static: StaticFolder) -> None:
        self.hub, self.login, self.cookie, self.static = hub, login, cookie, static


class Guarded(web.RequestHandler):
    """A handler that refuses requests with a foreign Host or Origin header."""

    styles = protection.OWN_STYLES

    @property
    def context(self) -> Context:
        """The shared data."""
        context: Context = self.settings["context"]
        return context

    @property
    def host(self) -> str:
        """The Host header, if it names the address at which the connection has arrived; otherwise empty."""
        connection = self.request.connection
        local: tuple[str, int] = connection.stream.socket.getsockname()  # type: ignore[union-attr]
        host = self.request.headers.get("Host", "")
        return host if protection.host_allowed(host, *local, self.context.login.addresses) else ""

    def set_default_headers(self) -> None:
        """Set the headers of every reply, errors included."""
        for name, value in protection.headers(self.host, self.styles).items():
            self.set_header(name, value)

    def prepare(self) -> None:
        """Refuse a request with a foreign Host header or, unless it only reads, with a foreign Origin header."""
        acts = self.request.method != "GET" or "Upgrade" in self.request.headers
        if not self.host:
            self.reject(403, protection.FOREIGN_HOST)
        elif acts and not protection.origin_allowed(self.request.headers.get("Origin"), self.host):
            self.reject(403, protection.FOREIGN_ORIGIN)

    def get_template_namespace(self) -> dict[str, object]:
        """Return what every template may use: also the path of the static files, and emoji."""
        return super().get_template_namespace() | {"static": self.context.static.root, "emoji": EMOJI}

    def reject(self, status: int, sentence: str) -> None:
        """Reply with a sentence and end the request."""
        self.set_status(status)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(sentence)

    def write_error(self, status_code: int, **_: object) -> None:
        """Reply with the name of the error, never with a traceback."""
        self.reject(status_code, f"{status_code}: {self._reason}")

    @property
    def visitor(self) -> str | None:
        """The name of the browser, if it is logged in; the page proposes it for the seat."""
        return self.context.login.visitor(self.ticket)

    @property
    def ticket(self) -> str:
        """The cookie of a browser that is, or was, logged in; empty without one."""
        return (self.get_signed_cookie(self.context.cookie, max_age_days=COOKIE_DAYS) or b"").decode()

    def admit(self, ticket: str) -> None:
        """Log in this browser."""
        days = COOKIE_DAYS if self.context.login.kind == "word" else None  # else until the browser is closed
        self.set_signed_cookie(self.context.cookie, ticket, days, httponly=True, samesite="Strict")
        self.redirect(self.request.path, status=303)


class Nothing(Guarded):
    """Replies to requests with an unknown path."""

    def get(self) -> None:
        """Reply with status 404."""
        self.reject(404, NOTHING)


class StaticFiles(Guarded):
    """The files of the folder `static`: style sheets, scripts, icons."""

    def get(self, name: str) -> None:
        """Send a file, which the browser may keep for good: another content has another path."""
        file = self.context.static.files.get(name)
        if file is None:
            self.reject(404, NOTHING)
            return
        zipped = "gzip" in self.request.headers.get("Accept-Encoding", "")
        self.set_header("Content-Type", file.kind)
        self.set_header("Cache-Control", "public, max-age=31536000, immutable")
        self.set_header("Vary", "Accept-Encoding")
        if zipped:
            self.set_header("Content-Encoding", "gzip")
        self.finish(file.compressed if zipped else file.content)


class Front(Guarded):
    """The control page, or the form for the PIN."""

    template = "page.html"
    styles = protection.BLOCK_STYLES

    def get(self) -> None:
        """Show the page to a browser that is logged in; otherwise show the form, or log in if nothing is needed."""
        if self.visitor is not None:
            self.render(self.template, token=self.xsrf_token.decode(), name=self.visitor)
        elif self.context.login.kind:
            self.form()
        elif self.request.headers.get("Sec-Fetch-Dest", "document") != "document":
            self.reject(403, protection.FOREIGN_ORIGIN)
        else:
            self.admit(self.context.login.enter("", "", time.monotonic()).ticket)

    def post(self) -> None:
        """Check a PIN or word; log in the browser if it is right."""
        typed = self.get_body_argument("typed", "")
        entry = self.context.login.enter(typed, self.request.remote_ip or "", time.monotonic())
        if entry.ticket:
            self.admit(entry.ticket)
        else:
            self.set_status(403)
            self.form(entry.refusal, entry.wait_s)

    def form(self, refusal: str = "", wait_s: float = 0.0) -> None:
        """Show the form, with the text of the key `refusal`, if what was typed was refused."""
        wanted = self.request.headers.get("Accept-Language", "")[:2]
        language = wanted if wanted in LANGUAGES else DEFAULT_LANGUAGE
        kind, text = self.context.login.kind, Texts(language)
        sentence = text(refusal, seconds=wait_s) if refusal else ""
        self.render("login.html", refusal=sentence, language=language, text=text, kind=kind)


class Projector(Front):
    """The page that a projector shows to the class; it only reads."""

    template = "class.html"
    styles = protection.OWN_STYLES


class Stopper(Guarded):
    """STOP as a POST request, in case the web socket is broken."""

    def post(self) -> None:
        """Send STOP."""
        visitor = self.visitor
        if visitor is None:
            self.reject(403, protection.NO_COOKIE)
            return
        try:
            stop = msgspec.json.decode(self.request.body, type=messages.StopRobot)
        except msgspec.DecodeError as error:
            self.reject(400, f"This STOP cannot be read: {error}.")
            return
        self.context.hub.stop(visitor, stop.robot, stop.stop)


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
    messages.StopRobot: lambda hub, face, request: hub.stop(face.visitor, request.robot, request.stop, face),
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
        start = self.context.hub.start_pictures
        self._cameras = start(self, self.visitor or "", place, self.changed, both=both)
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
        self.context.hub.end_pictures(self)
