"""STOP of pages: it goes through the session that all pages share, not over the router of the seats, which may hang."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial
from typing import Final

from beatrix_zenoh.client import Client
from beatrix_zenoh.client.stopping import StopSender
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract import names
from gui.console.link.connection import Session
from gui.console.link.stopping import send_stop
from gui.console.state.actions import SendStop
from gui.console.state.intents import Stop
from gui.page.face import Face
from gui.page.protection import Login

STOPS_KEPT: Final = 1024


class Stops:
    """Sends STOP for pages and browsers; its methods run on the thread of the server's loop."""

    def __init__(
        self,
        session: Callable[[], Session | None],
        login: Login,
        pages: Collection[Face],
        call: Callable[..., None],
    ) -> None:
        """Start the sender.

        Args:
            session: returns the session that all pages share, if there is one.
            login: the browsers and their seats.
            pages: all open pages, at any time.
            call: runs a function with its arguments on the server's loop; any thread may use it.
        """
        self._session, self._login, self._pages, self._call = session, login, pages, call
        self._sender = StopSender("web")
        self._newest: deque[tuple[str, str]] = deque(maxlen=STOPS_KEPT)
        """the newest STOPs, by browser and number: a page sends each STOP over two connections"""

    def of_page(self, face: Face, action: SendStop) -> bool:
        """Send STOP of a page; return whether there is a session."""
        session = self._session()
        if session is not None:
            client = self._as(face.visitor, session.client)
            session = replace(session, client=client, twin=Twin(face.robot, client=client))
            send_stop(self._sender, action, session, partial(self._call, face.report))
        return session is not None

    def of_browser(self, visitor: str, robot: str, stop: str, page: Face | None = None) -> None:
        """Send STOP to simulation and hardware of a name, for any page; ignore it if its number `stop` came before.

        Other pages that drive this robot drop what waits to be sent. If `page` does not show the robot, one of this
        browser that does reports the outcome; without such a page, no page does.
        """
        if not names.PATTERN.fullmatch(robot) or (visitor, stop) in self._newest:
            return
        self._newest.append((visitor, stop))
        own = [one for one in self._pages if one.visitor == visitor and one.robot == robot]
        page = page if page in own else next(iter(sorted(own, key=lambda one: one.driver is None)), None)
        for other in self._pages:
            if other is not page and other.robot == robot and other.driver is not None:
                other.driver.link.drop()
        session = self._session()
        if page is not None:
            page.carry_out(Stop())
        elif session is not None:
            self._sender.send([self._as(visitor, session.client)], [(robot, "*")], lambda _: None)

    def _as(self, visitor: str, client: Client) -> Client:
        """Return the session for STOP of a browser: in a class under its seat."""
        return client.under(visitor) if self._login.shown(visitor) else client

    def close(self) -> None:
        """Send what waits, and end the sender; returns at once."""
        self._sender.close()

    def join(self, deadline_s: float) -> None:
        """Wait until the sender has ended, at most until a time of the monotonic clock (s)."""
        self._sender.join(deadline_s)
