"""One router of a class, in a process of its own: `python -m beatrix_zenoh.classroom.router_process PART`.

The first line of standard input is the router file as JSON, so that its keys are in no second file. The process ends with
its standard input, so also with its parent. It prints lines of JSON, each a list: what has happened, and its data.
"""

from __future__ import annotations

import contextlib
import os
import queue
import sys
import time
from collections import deque
from collections.abc import Callable
from typing import Final

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.classroom.router_file import CHECK_KEY, Part, RouterFile
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.output import FAILED

TOKENS_MAX: Final = 1000
"""Largest number of liveliness tokens that an account may declare in WINDOW_S: a loop that opens a session each time
declares 300. With 8 000 tokens one seat made the router disconnect the robots (measured)."""
WINDOW_S: Final = 10.0
LINK_S, POLL_S = 5.0, 0.01
"""Longest time (s) to wait for the other router, without which seats reach no robot, and period of looking for it."""
CHECK_S: Final = 0.2
"""Longest time (s) of one query to the other router."""
MEMORY: Final = 1 << 30
"""Largest amount of memory (bytes); a router of a class with thirty robots and seats needs less than a fifth. A key of
some thousand chunks takes Zenoh up to a gigabyte, which it keeps for ever."""
Event = Callable[[], None]


def floods(times: deque[float], now_s: float) -> bool:
    """Count a token of an account whose newest ones came at these times; return whether it is one too many."""
    too_many = len(times) == TOKENS_MAX and now_s - times[0] <= WINDOW_S
    times.append(now_s)
    return too_many


class RouterProcess:
    """The router of this process, and what happens at it; Zenoh's threads only put it into a queue."""

    def __init__(self, part: Part, file: RouterFile) -> None:
        """Open the router; raises the errors of `open_router`."""
        self._session = zbus.open_router(file.endpoint(part), file.access(part))
        self._names = {file.accounts[name]: name for name in file.own(part)}
        self._connected: dict[str, str] = {}
        """account by address"""
        self._tokens: dict[str, deque[float]] = {}
        """times of the newest tokens of each account (monotonic clock, s)"""
        self._events: queue.SimpleQueue[Event | None] = queue.SimpleQueue()
        self._checks = None if part is Part.SEATS else zbus.answer_checks(self._session, CHECK_KEY)
        self._watched = zbus.watch_router(self._session, self._on_link, self._on_token)
        self._token: object = None
        threads.start(self._read, "parent")
        if part is Part.SEATS:
            self._token = self._session.liveliness().declare_token(
                keys.seats_router(str(self._session.zid()))
            )
            self._wait_for_other()

    def _wait_for_other(self) -> None:
        """Wait until the other router answers through their connection: before, it drops reports, motions and STOPs.

        It has passed on its subscriptions some ms earlier, and then still dropped 1 of 200 reports (measured).
        """
        deadline_s = time.monotonic() + LINK_S
        while not self._other_answers() and time.monotonic() < deadline_s:
            time.sleep(POLL_S)

    def _other_answers(self) -> bool:
        query = zbus.Query(self._session, CHECK_KEY, None, None, timeout_s=CHECK_S)
        return next(query.replies(CHECK_S), None) is not None

    def _on_link(self, common_name: str, address: str, opened: bool) -> None:  # noqa: FBT001
        def handle() -> None:
            if opened and common_name in self._names:
                self._connected[address] = self._names[common_name]
            elif not opened:
                self._connected.pop(address, None)
            _print("connected", sorted({*self._connected.values()}))

        self._events.put(handle)

    def _on_token(self, key: str) -> None:
        def handle() -> None:
            parts = keys.parse(key)
            account = "" if parts is None else parts.who or parts.robot
            times = self._tokens.setdefault(account, deque(maxlen=TOKENS_MAX))
            if account in self._names.values() and floods(times, time.monotonic()):
                _print("flood", account)
                self._events.put(None)

        self._events.put(handle)

    def _read(self) -> None:
        """Wait until the parent closes this process's input."""
        sys.stdin.read()
        self._events.put(None)

    def run(self) -> None:
        """Handle events until the parent closes this process's input, or an account has declared too many tokens."""
        while (event := self._events.get()) is not None:
            event()


def main() -> int:
    """Run one router of a class until the end of standard input; return the exit code."""
    file = msgspec.json.decode(sys.stdin.readline(), type=RouterFile)
    _limit_memory()
    try:
        router = RouterProcess(Part(sys.argv[1]), file)
    except BeatrixError as error:
        _print("failed", error.reason, error.message)
        return FAILED
    _print("ready")
    router.run()
    return 0


def _limit_memory() -> None:
    """Limit the memory of this process to MEMORY; above it, Zenoh ends the process, and the parent starts it again.

    No core file is written: each end would fill the disk with up to MEMORY.
    """
    if sys.platform == "linux":
        import resource  # noqa: PLC0415  # Windows has none

        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _print(event: str, *data: object) -> None:
    with contextlib.suppress(BrokenPipeError):  # the parent was killed, and this process ends, too
        sys.stdout.write(msgspec.json.encode([event, *data]).decode() + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    code = main()
    os._exit(code)  # closing the session would wait for clients that do not read
