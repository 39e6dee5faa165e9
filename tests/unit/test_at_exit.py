"""The sessions that a program leaves open: closed at its exit, or kept if there is no time to close them."""

from __future__ import annotations

import gc
import threading
import weakref

import pytest

from beatrix_zenoh.bus import at_exit


class Native:
    """Stands for an object of Zenoh, whose deletion closes a session."""


class Session:
    """A session that is closed or not."""

    def __init__(self, native: Native) -> None:
        self._native = native
        self.closed = False

    def close(self) -> None:
        self.closed = True

    def objects(self) -> object:
        return (self._native,)


@pytest.mark.parametrize(("close_s", "closed"), [(2.0, True), (-1.0, False)])
def test_a_session_is_closed_or_its_native_objects_outlive_it(
    monkeypatch: pytest.MonkeyPatch, close_s: float, closed: bool
) -> None:
    monkeypatch.setattr(at_exit, "CLOSE_S", close_s)
    native = Native()
    remains, session, sessions = weakref.ref(native), Session(native), at_exit.OpenSessions()
    del native
    sessions.add(session)
    sessions.close()
    assert session.closed is closed
    del session
    gc.collect()
    assert (remains() is None) is closed


def test_the_exit_waits_for_threads_that_receive() -> None:
    closing, sessions = threading.Event(), at_exit.OpenSessions()
    ended: list[int] = []

    class Receiving(Session):
        def close(self) -> None:
            closing.set()

    def receive() -> None:
        with sessions.receiver():
            inside.set()
            closing.wait(5.0)
            for number in range(100_000):  # long enough that an exit which does not wait is earlier
                ended[:] = [number]

    inside, session = threading.Event(), Receiving(Native())
    sessions.add(session)
    thread = threading.Thread(target=receive)
    thread.start()
    assert inside.wait(5.0)
    sessions.close()
    assert ended == [99_999]
    thread.join(5.0)
