"""A session of a client of a router: liveliness tokens, the state of the router and of the account, robots online."""

from __future__ import annotations

import contextlib
import datetime as dt
import time
from collections.abc import Callable

import zenoh

from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import credentials
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.bus.endpoint import endpoints, is_listening, parse_endpoint, probe, speaks_another_zenoh
from beatrix_zenoh.bus.messages import TOKEN, WATCH, MessageSession
from beatrix_zenoh.bus.transport import OPEN_MS, RETRY, opened
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage

OTHER_CAUSES = (
    " Or other programs keep it busy with connections that it refuses; the teacher ends that by a restart of the router. "
    "Or it does not use certificates: it serves no class."
)
"""What else may be wrong if a router with TLS does not answer."""
AGAIN_S = 0.3
"""Time (s) after which a session is opened once more: a router that has just started may have begun to listen after the
first attempt, and does not refuse the account."""
STAYS_S = 0.3
"""Time (s) after which a router has not closed the session of an account that it has put out."""
OTHER_ZENOH = (
    "The router at {} speaks another version of Zenoh's protocol, for example that of Zenoh 0.11; BEATRIX needs Zenoh 1. "
    "End it and start `beatrix router`, or name another router with --connect or BEATRIX_CONNECT."
)
POLL_S = 0.02
ROUTER_S = 1.0
"""A router that needs longer than this (s) for a query about tokens, or to connect a session again, counts as unresponsive."""


class Bus(MessageSession):
    """One Zenoh session: a client of an explicit router, without discovery and shared memory."""

    def __init__(
        self, open_session: Callable[[], zenoh.Session], endpoint: str, account: Account | None = None
    ) -> None:
        super().__init__(open_session)
        self._account = account
        self.endpoint = endpoint
        self.session_id = self.use(lambda session: str(session.zid()))

    def declare_token(self, key: str) -> Callable[[], None]:
        """Declare a liveliness token, which disappears when this session ends for any reason.

        Returns a function that ends the token; raises the errors of `query`.
        """
        return self.add(TOKEN, key, lambda session: session.liveliness().declare_token(key))

    def tokens(self, key: str, timeout_s: float = 1.0) -> list[str]:
        """Return the keys of the live tokens that match; raises the errors of `query`."""
        replies = self.use(lambda session: list(session.liveliness().get(key, timeout=timeout_s)))
        return sorted(str(reply.ok.key_expr) for reply in replies if reply.ok is not None)

    def router_answers(self, timeout_s: float = ROUTER_S) -> bool:
        """Return whether the router answers a query about tokens within `timeout_s` (s)."""
        begin = time.monotonic()
        if not self.connected or self.tokens(keys.claim("*", "*", "none"), timeout_s):
            return False
        in_time = time.monotonic() - begin < timeout_s
        time.sleep(POLL_S)  # a query also ends with the connection, which Zenoh still lists for a moment
        return in_time and self.connected

    def silence(self) -> NoAnswer | None:
        """Return the error of a router that accepts connections and does not answer; None if it answers, or is absent."""
        deadline_s = time.monotonic() + ROUTER_S
        while not self.connected and time.monotonic() < deadline_s:
            time.sleep(POLL_S)
        if self.router_answers() or not is_listening(self.endpoint):
            return None
        return NoAnswer(Reason.NO_ROUTER, hanging_router(self.endpoint))

    def refusal(self) -> NoAnswer | None:
        """Return the error if the router refuses the account; None if it accepts it, or cannot be reached.

        A session of an account that was put out is open for a moment twice a second, so another session is tried.
        """
        if self._account is None:
            return None
        error = self.connection_error()
        return error if error is not None and error.reason is Reason.ACCOUNT_REFUSED else None

    def watch_tokens(self, key: str, handle: Callable[[str, bool], None]) -> Callable[[], None]:
        """Report tokens that appear or disappear, first the existing ones; return a function that ends the reports.

        `handle(key, alive)` runs on Zenoh's thread and must return at once.
        """

        def receive(sample: zenoh.Sample) -> None:
            handle(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        return self.add(
            WATCH,
            key,
            lambda session: session.liveliness().declare_subscriber(key, direct(receive), history=True),
        )

    def watch_router(self, handle: Callable[[bool], None]) -> Callable[[], None]:
        """Call `handle(connected)` when the router connects or disconnects, and once if it is connected now.

        Return a function that ends the calls.
        """

        def receive(event: zenoh.TransportEvent) -> None:
            handle(event.kind == zenoh.SampleKind.PUT)

        return self.add(
            WATCH,
            "",
            lambda session: session.info.declare_transport_events_listener(direct(receive), history=True),
        )

    @property
    def connected(self) -> bool:
        """Whether a router is connected; false after `close`."""
        with contextlib.suppress(WrongUsage):
            return self.use(lambda session: bool(session.info.routers_zid()))
        return False

    def connection_error(self) -> NoAnswer | None:
        """Try to open another session with the same account; return the error, or None if the router accepts it.

        A router that has put an account out closes each of its sessions at once.
        """
        try:
            with Bus(self._open_session, self.endpoint) as second:
                deadline_s = time.monotonic() + STAYS_S
                while self._account is not None and second.connected:
                    if time.monotonic() > deadline_s:
                        return None
                    time.sleep(POLL_S)
        except NoAnswer as error:
            return error
        if self._account is None:
            return None
        return NoAnswer(Reason.ACCOUNT_REFUSED, credentials.refused(self.endpoint, self._account))

    def robots(self, timeout_s: float = 1.0) -> list[tuple[str, str]]:
        """Return name and side of every robot online."""
        found = map(keys.parse, self.tokens(keys.alive("*", "*"), timeout_s))
        return [(parts.robot, parts.side) for parts in found if parts is not None]


def hanging_router(endpoint: str) -> str:
    """Return the message about a router that accepts connections and does not answer."""
    return (
        f"The router at {endpoint} does not answer: it hangs or is very busy. Robots stop by themselves within 3 s "
        "of losing their router."
    )


def connect(endpoint: str, *, label: str = "", account: Account | None = None) -> Bus:
    """Open a session as a client of the router at an endpoint such as `tcp/127.0.0.1:7447`, or at one of several.

    Raises:
        NoAnswer: NO_ROUTER or ACCOUNT_REFUSED, with what to do.
        WrongUsage: BAD_VALUE, `endpoint` is invalid, the certificate of the account has expired, or this process was
            forked from one that has connected.
    """
    for one in endpoints(endpoint):
        parse_endpoint(one)
    if account is not None:
        account.check_time(dt.datetime.now().astimezone().date())
    settings = {
        "mode": "client",
        "connect/endpoints": endpoints(endpoint),
        "connect/timeout_ms": 0,
        "connect/retry": RETRY,
        "scouting/gossip/enabled": False,
        "metadata": {"name": label},
        **credentials.settings(account),
    }

    def check_listening() -> None:
        try:
            probe(endpoint)
        except NoAnswer as error:
            raise credentials.no_router(error, account) from error

    def open_session(*, again: bool = True) -> zenoh.Session:
        if account is None:
            check_listening()  # after a connection without a handshake, TLS accepts none for 0.1 s
        begin = time.monotonic()
        try:
            return opened(settings, "", Reason.ACCOUNT_REFUSED)
        except NoAnswer as error:
            slow = time.monotonic() - begin > OPEN_MS / 1e3 * 0.9
            check_listening()  # a router that is absent or shuts down did not refuse the account
            if again and not slow:
                time.sleep(AGAIN_S)
                return open_session(again=False)
            if slow:
                other = "" if account is None else OTHER_CAUSES
                raise NoAnswer(Reason.NO_ROUTER, hanging_router(endpoint) + other) from error
            if account is None and speaks_another_zenoh(endpoint):
                raise NoAnswer(Reason.NO_ROUTER, OTHER_ZENOH.format(endpoint)) from error
            raise NoAnswer(error.reason, credentials.refusal(endpoint, account) + error.message) from error

    return Bus(open_session, endpoint, account)
