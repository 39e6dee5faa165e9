"""Requests of browsers: the page, the login, static files, and STOP."""

from __future__ import annotations

import time
from typing import Final

import msgspec
from tornado import web

from gui.console.state.own_gestures import EMOJI
from gui.console.texts import DEFAULT_LANGUAGE, LANGUAGES, Texts
from gui.page import messages, protection
from gui.page.hub import Hub
from gui.page.protection import Login
from gui.page.static_files import StaticFolder

NOTHING: Final = "This server has no such page. The control page is at /."
COOKIE_DAYS: Final = 200
"""How long a browser keeps the seat of a class."""


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
        self.context.hub.stops.of_browser(visitor, stop.robot, stop.stop)
