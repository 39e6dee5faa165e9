"""The end of a process: its exit code, and shutdown by a signal or by a thread."""

from __future__ import annotations

import queue
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from beatrix_zenoh import hiding

FAULT = 70
"""Exit code after an exception that no code handles (EX_SOFTWARE of sysexits.h), unlike that of a refusal."""
INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells use it."""
SIGNALS = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)
]
"""Signals that request a shutdown: Ctrl-C, kill, a closed terminal window, Ctrl-Break on Windows."""
POLL_S = 0.5
"""Longest single wait (s): Python handles Ctrl-C on Windows, and on Linux a signal that another thread received, only
between two waits."""


class Shutdown:
    """A request to shut down, made by a signal or by a thread that cannot continue.

    Not a threading.Event, because setting it takes a lock, which the interrupted thread may already hold.
    """

    def __init__(self) -> None:
        self._requests: queue.SimpleQueue[None] = queue.SimpleQueue()

    def handle_signals(self) -> None:
        """Install the signal handlers; SIGHUP stays ignored if the process was started with nohup."""
        for number in SIGNALS:
            if number in (signal.SIGINT, signal.SIGTERM) or signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._on_signal)

    def _on_signal(self, _signal: int, _frame: FrameType | None) -> None:
        self.request()

    def request(self) -> None:
        """Request the shutdown; callable from any thread and signal handler."""
        self._requests.put(None)

    def requested(self, timeout_s: float) -> bool:
        """Wait up to `timeout_s` for a request and return whether there is one; later calls return True, too."""
        try:
            self._requests.get(timeout=timeout_s)
        except queue.Empty:
            return False
        self._requests.put(None)
        return True

    def wait(self, meanwhile: Callable[[], None] = lambda: None) -> None:
        """Wait until a shutdown is requested, and call `meanwhile` twice a second until then."""
        while not self.requested(POLL_S):
            meanwhile()


def ignore_signals() -> None:
    """Ignore the signals while Python exits, after the work is done."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def signals_interrupt() -> Iterator[Shutdown]:
    """Raise KeyboardInterrupt in this block for every signal that requests a shutdown, also in a background job.

    The value of the block is requested, too: Python ignores an exception in a destructor or in a callback of the
    garbage collector, so that a loop without end must also ask for it.
    """
    shutdown = Shutdown()

    def interrupt(_signal: int, _frame: FrameType | None) -> None:
        shutdown.request()
        raise KeyboardInterrupt

    with handled(interrupt):
        yield shutdown


@contextmanager
def signals_ignored() -> Iterator[None]:
    """Ignore these signals in this block, which must end within a bounded time."""
    with handled(signal.SIG_IGN):
        yield


@contextmanager
def handled(handler: Callable[[int, FrameType | None], None] | signal.Handlers) -> Iterator[None]:
    """Let a handler handle these signals in this block."""
    # SIGHUP stays ignored under nohup. SIGINT is handled even where a shell ignores it for background jobs.
    numbers = [n for n in SIGNALS if n == signal.SIGINT or signal.getsignal(n) is not signal.SIG_IGN]
    before = [(number, signal.signal(number, handler)) for number in numbers]
    try:
        yield
    finally:
        for number, previous in before:
            signal.signal(number, previous)


def interrupted(error: BaseException) -> bool:
    """Return whether Ctrl-C has caused this error: libraries in C turn it into an ImportError while they are loaded."""
    known: BaseException | None = error
    while known is not None:
        if isinstance(known, KeyboardInterrupt):
            return True
        known = known.__cause__ or known.__context__
    return False


def process(work: Callable[[], int]) -> None:
    """Run `work`, the whole task of this process; raise SystemExit with its exit code.

    The exit code is 130 after Ctrl-C, and FAULT after an exception, whose traceback is printed.
    """
    try:
        code = work()
        ignore_signals()  # so that a signal cannot change the exit code now that the work is done
    except KeyboardInterrupt:
        code = INTERRUPTED
    except Exception as error:  # noqa: BLE001 - prints the traceback, as Python would before it ends with exit code 1
        code = 1
        if interrupted(error):
            code = INTERRUPTED
        elif why := hiding.cause(error):
            sys.stderr.write(f"{why}\n")
        else:
            traceback.print_exc()
            code = FAULT
    sys.exit(code)
