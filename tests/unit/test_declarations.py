"""The declarations of a session: threads that declare, end declarations, renew and close at the same time."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import cast

import pytest
import zenoh

from beatrix_zenoh.bus import Bus
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage

THREADS, ROUNDS, RENEWALS = 4, 30, 10
END_S = 30.0


class FakeSession:
    """A session without a router, which stores what is declared in it.

    `while_undeclaring` runs in every undeclaration, as Zenoh may wait there for a callback that runs.
    """

    def __init__(self) -> None:
        self.live: set[FakeDeclaration] = set()
        self.closed = False
        self.while_undeclaring: Callable[[], None] = lambda: None

    def zid(self) -> str:
        return "abc"

    def liveliness(self) -> FakeSession:
        return self

    def declare_subscriber(self, key: str, *_: object, **__: object) -> FakeDeclaration:
        if self.closed:
            raise zenoh.ZError("session closed")
        made = FakeDeclaration(self, key)
        os.sched_yield()  # Zenoh also lets other threads run here
        self.live.add(made)
        return made

    declare_token = declare_queryable = declare_publisher = declare_subscriber

    def close(self) -> None:
        self.closed = True
        self.live.clear()


class FakeDeclaration:
    def __init__(self, session: FakeSession, key: str) -> None:
        self._session, self.key = session, key

    def undeclare(self) -> None:
        self._session.while_undeclaring()
        os.sched_yield()
        self._session.live.discard(self)


class Opened:
    """A `Bus` and its fake sessions, in the order in which they were opened."""

    def __init__(self) -> None:
        self.sessions: list[FakeSession] = []
        self.bus = Bus(self._open, "tcp/127.0.0.1:1")

    def _open(self) -> zenoh.Session:
        self.sessions.append(FakeSession())
        return cast("zenoh.Session", self.sessions[-1])

    def live(self) -> list[str]:
        """Return the keys that are declared in any session, sorted."""
        return sorted(made.key for session in self.sessions for made in session.live)

    def change(self, name: str, kept: list[str]) -> None:
        """Declare in ROUNDS rounds, end every second declaration; add the keys of the others to `kept`."""
        for number in range(ROUNDS):
            key = f"{name}/{number}"
            subscriber = self.bus.subscribe(f"{key}/subscriber", lambda _: None)
            token = self.bus.declare_token(f"{key}/token")
            if number % 2:
                token()
                subscriber()
                subscriber()  # a second call has no effect
            else:
                kept += [f"{key}/subscriber", f"{key}/token"]


@pytest.fixture(autouse=True)
def frequent_switches() -> Iterator[None]:
    """Let Python switch to another thread at every call and return of a function."""
    threading.setprofile(lambda *_: os.sched_yield())
    yield
    threading.setprofile(None)


def in_threads(*work: Callable[[], object]) -> None:
    """Run functions at the same time; raise the first error, or TimeoutError if one does not end."""
    begin = threading.Barrier(len(work))

    def run(one: Callable[[], object]) -> None:
        begin.wait()
        one()

    with ThreadPoolExecutor(len(work)) as pool:
        for future in [pool.submit(run, one) for one in work]:
            future.result(END_S)


def until_closed(work: Callable[[], object]) -> None:
    """Call a function until it reports that the session is closed."""
    while True:
        try:
            work()
        except WrongUsage as error:
            assert error.reason is Reason.SHUTDOWN  # noqa: PT017  # most calls raise nothing
            return


def test_threads_that_declare_at_once_each_end_their_own_declarations_while_the_session_is_renewed() -> None:
    opened = Opened()
    kept: list[str] = []

    def renew() -> None:
        for _ in range(RENEWALS):
            opened.bus.renew()

    in_threads(renew, *(partial(opened.change, f"t{number}", kept) for number in range(THREADS)))
    assert opened.live() == sorted(kept)
    assert [session.closed for session in opened.sessions] == [True] * (len(opened.sessions) - 1) + [False]
    opened.bus.close()
    assert opened.live() == []


def test_a_session_that_closes_meanwhile_keeps_no_declaration_and_opens_no_session() -> None:
    for _ in range(8):
        opened = Opened()
        works: list[Callable[[], object]] = [opened.bus.renew]
        works += [partial(opened.change, f"t{number}", []) for number in range(THREADS)]
        in_threads(*(partial(until_closed, work) for work in works), opened.bus.close)
        assert opened.live() == []
        assert all(session.closed for session in opened.sessions)


def test_a_callback_may_declare_while_its_subscription_ends() -> None:
    opened = Opened()
    end = opened.bus.subscribe("first", lambda _: None)
    opened.sessions[0].while_undeclaring = lambda: in_threads(
        partial(opened.bus.subscribe, "second", lambda _: None)
    )
    end()
    assert opened.live() == ["second"]
