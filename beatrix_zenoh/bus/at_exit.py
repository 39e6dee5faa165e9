"""The end of a program that has left sessions open: they are closed before Python ends.

A daemon thread that returns from Zenoh into a Python that has ended aborts the whole process, because Python ends the
thread inside Rust (PyO3 issue 6084). So at the exit no thread may be inside Zenoh, nor may Zenoh call back.

At a router that hangs Zenoh needs up to 15 s to close one session. Python would close the others when it deletes them,
one after the other, and then abort, because by then it counts as not initialised (PyO3, gil.rs). So those are kept.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import os
import threading
import time
import weakref
from typing import Final, Protocol

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage

CLOSE_S: Final = 2.0
"""After this time (s) no further session is closed, and no call is waited for."""
CALLBACK_S: Final = 0.05
"""How long (s) callbacks that were running when their session was closed have time to return to Zenoh: without it 3 of
96 nodes that ended on a busy computer were aborted ("FATAL: exception not rethrown")."""


class Closes(Protocol):
    """An open session."""

    def close(self) -> None: ...

    def objects(self) -> object:
        """Return the objects of Zenoh that must be kept if the session is not closed."""
        ...


def keep(kept: object) -> None:
    """Prevent the deletion of an object and of what it refers to, also at the end of Python."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))


class OpenSessions:
    """The open sessions of this process, and the number of its threads that are inside Zenoh."""

    def __init__(self) -> None:
        self._sessions: weakref.WeakSet[Closes] = weakref.WeakSet()
        self._lock = threading.RLock()
        """That of `_changed`, which is slower, because it is written in Python: each query needs the lock several times."""
        self._changed = threading.Condition(self._lock)
        self._call = _Call(self)
        self._calls = 0
        self._closed_s = -CALLBACK_S
        self._ended = False

    def add(self, session: Closes) -> None:
        """Close this session at the exit, unless it is closed or deleted earlier."""
        self._sessions.add(session)

    def discard(self, session: Closes) -> None:
        """Forget a session that is closed now."""
        self._sessions.discard(session)
        self._closed_s = time.monotonic()

    def call(self) -> contextlib.AbstractContextManager[None]:
        """Surround a call of Zenoh, or a thread that receives until its session is closed.

        At the exit no call begins: threads of this package wait for the end of the process.

        Calls may be nested, because Zenoh may run a callback in the calling thread.

        Raises (on entry):
            WrongUsage: SHUTDOWN, Python ends; in a thread of another package.
        """
        return self._call

    def count(self, change: int) -> None:
        """Count a thread that enters Zenoh (1) or has returned from it (-1); on entry raises the error of `call`."""
        with self._lock:
            refused = self._ended and change > 0
            self._calls += 0 if refused else change
            if self._ended:
                self._changed.notify_all()
        if refused:
            if threads.ours():
                threading.Event().wait()
            raise WrongUsage(Reason.SHUTDOWN, "This program ends: its connections are closed.")

    def close(self) -> None:
        """Close all open sessions and wait until no thread is inside Zenoh; for use at the exit."""
        deadline_s = time.monotonic() + CLOSE_S
        with self._changed:
            self._ended = True
        opened = list(self._sessions)
        for session in opened:
            if time.monotonic() < deadline_s:
                session.close()
            else:
                keep(session.objects())
        with self._changed:
            self._changed.wait_for(lambda: not self._calls, max(0.0, deadline_s - time.monotonic()))
        time.sleep(max(0.0, self._closed_s + CALLBACK_S - time.monotonic()))

    def forget(self) -> None:
        """Forget all sessions and calls in a forked child, which has only a copy of them."""
        self.__init__()  # type: ignore[misc]


class _Call(threading.local):
    """The context of `OpenSessions.call`, with the depth of nested calls of each thread.

    A class, because a context made by a generator takes 50 us when the caches are cold, and each query needs several.
    """

    depth = 0

    def __init__(self, sessions: OpenSessions) -> None:
        self._sessions = sessions

    def __enter__(self) -> None:
        if not self.depth:
            self._sessions.count(1)
        self.depth += 1

    def __exit__(self, *exc: object) -> None:
        self.depth -= 1
        if not self.depth:
            self._sessions.count(-1)


OPEN: Final = OpenSessions()
"""The only instance: a process has one exit."""
atexit.register(OPEN.close)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=OPEN.forget)
