"""One router of a class, in a process of its own: `python -m beatrix_zenoh.classroom.router_process PART`.

The first line of standard input is the router file as JSON, so that its keys are in no second file. Each later line is a
JSON list of accounts whose sessions end, and may not come back. The process ends with its standard input, so also with
its parent. It prints lines of JSON, each a list: what has happened, and its data.
"""

from __future__ import annotations

import contextlib
import math
import os
import queue
import sys
import time
from collections import deque
from collections.abc import Callable, Collection
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
OUT_S: Final = 60.0
"""Time for which a seat with too many tokens is kept out."""
LINK_S, POLL_S = 5.0, 0.01
"""Longest time (s) to wait for the other router, without which seats reach no robot, and period of looking for it."""
CHECK_S: Final = 0.2
"""Longest time (s) of one query to the other router."""
MEMORY: Final = 1 << 30
"""Largest amount of memory (bytes); a router of a class with thirty robots and seats needs less than a fifth. A key of
some thousand chunks takes Zenoh up to a gigabyte, which it keeps for ever."""
Event = Callable[[], None]


class Guests:
    """The accounts that are connected to a router, and those that are kept out of it. Times in s, monotonic clock."""

    def __init__(self, accounts: Collection[str], end: Callable[[Collection[str]], None]) -> None:
        """`end` closes the connections to some addresses."""
        self._accounts, self._end = frozenset(accounts), end
        self._connected: dict[str, str] = {}
        """account by address"""
        self._out_until: dict[str, float] = {}
        self._tokens: dict[str, deque[float]] = {}

    @property
    def connected(self) -> list[str]:
        """The accounts that are connected."""
        return sorted({*self._connected.values()})

    def link(self, account: str, address: str, now_s: float, *, opened: bool) -> None:
        """Handle a connection that has begun or ended."""
        if not opened:
            self._connected.pop(address, None)
        elif account in self._accounts:
            self._connected[address] = account
            if now_s < self._out_until.get(account, 0.0):
                self._end({address})

    def put_out(self, account: str, until_s: float) -> None:
        """End all connections of an account, and each new one until a time."""
        self._out_until[account] = until_s
        self._end({address for address, name in self._connected.items() if name == account})

    def token(self, account: str, now_s: float) -> bool:
        """Count a token; return True, and put the account out, if it was one too many."""
        if account not in self._accounts or now_s < self._out_until.get(account, 0.0):
            return False
        times = self._tokens.setdefault(account, deque(maxlen=TOKENS_MAX + 1))
        times.append(now_s)
        if len(times) <= TOKENS_MAX or now_s - times[0] > WINDOW_S:
            return False
        times.clear()
        self.put_out(account, now_s + OUT_S)
        return True


class RouterProcess:
    """The router of this process, and what happens at it; Zenoh's threads only put it into a queue."""

    def __init__(self, part: Part, file: RouterFile) -> None:
        """Open the router; raises the errors of `open_router`."""
        self._session = zbus.open_router(file.endpoint(part), file.access(part))
        self._names = {file.accounts[name]: name for name in file.own(part)}
        self._guests = Guests(self._names.values(), zbus.close_connections)
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
        return zbus.Query(self._session, CHECK_KEY, None, None, timeout_s=CHECK_S).is_answered(CHECK_S)

    def _on_link(self, common_name: str, address: str, opened: bool) -> None:  # noqa: FBT001
        def handle() -> None:
            account = self._names.get(common_name, "")
            self._guests.link(account, address, time.monotonic(), opened=opened)
            _print("connected", self._guests.connected)

        self._events.put(handle)

    def _on_token(self, key: str) -> None:
        def handle() -> None:
            parts = keys.parse(key)
            account = "" if parts is None else parts.who or parts.robot
            if self._guests.token(account, time.monotonic()):
                _print("flood", account)

        self._events.put(handle)

    def _read(self) -> None:
        """Read the accounts to put out, until the parent closes this process's input."""
        for line in sys.stdin:
            self._events.put(lambda line=line: self._put_out(line))  # type: ignore[misc]
        self._events.put(None)

    def _put_out(self, line: str) -> None:
        for account in msgspec.json.decode(line, type=list[str]):
            self._guests.put_out(account, math.inf)

    def run(self) -> None:
        """Handle events until the parent closes this process's input."""
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
