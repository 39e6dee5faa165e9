"""The sessions that a program leaves open: closed at its exit, or kept if there is no time to close them."""

from __future__ import annotations

import gc
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
