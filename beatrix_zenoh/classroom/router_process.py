"""One router of a class, in a process of its own: `python -m beatrix_zenoh.classroom.router_process PART`.

The first line of standard input is the router file as JSON, so that its keys are in no second file. Each later line is a
JSON list of accounts whose sessions end, and may not come back. The process ends with its standard input, so also with
its parent. It prints lines of JSON, each a list: what has happened, and its data.
"""

from __future__ import annotations

import contextlib
import os
import queue
import sys
import time
from collections import Counter, deque
from collections.abc import Callable, Collection
from typing import Final

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.classroom.router_file import Part, RouterFile
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.output import FAILED

TOKENS_MAX: Final = 200
"""Largest number of liveliness tokens that a seat may declare in WINDOW_S: a program declares some ten when it starts.
With 8 000 tokens one seat made the router disconnect the robots (measured)."""
WINDOW_S: Final = 10.0
OUT_S: Final = 60.0
"""Time for which a seat with too many tokens is kept out."""
LINK_S, POLL_S = 5.0, 0.01
"""Longest time (s) to wait for the other router, without which seats reach no robot, and period of looking for it."""
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
    def connected(self) -> Counter[str]:
        """Number of connections of each account."""
        return Counter(self._connected.values())

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


def main() -> int:
    """Run one router of a class until the end of standard input; return the exit code."""
    part = Part(sys.argv[1])
    file = msgspec.json.decode(sys.stdin.readline(), type=RouterFile)
    _limit_memory()
    try:
        session = zbus.open_router(file.endpoint(part), file.access(part))
    except BeatrixError as error:
        _print("failed", error.reason, error.message)
        return FAILED
    events: queue.SimpleQueue[Event | None] = queue.SimpleQueue()
    names = {file.accounts[name]: name for name in file.own(part)}
    guests = Guests(names.values(), zbus.close_connections)

    def link(common_name: str, address: str, opened: bool) -> None:  # noqa: FBT001
        def handle() -> None:
            guests.link(names.get(common_name, ""), address, time.monotonic(), opened=opened)
            _print("connected", guests.connected)

        events.put(handle)

    def count(key: str) -> None:
        parts = keys.parse(key)
        account = "" if parts is None else parts.who or parts.robot
        if guests.token(account, time.monotonic()):
            _print("flood", account)

    def put_out(line: str) -> None:
        for account in msgspec.json.decode(line, type=list[str]):
            guests.put_out(account, float("inf"))

    def listen() -> None:
        for line in sys.stdin:
            events.put(lambda line=line: put_out(line))  # type: ignore[misc]
        events.put(None)

    watched = zbus.watch_router(session, link, lambda key: events.put(lambda: count(key)))
    token = None
    if part is Part.SEATS:
        token = session.liveliness().declare_token(keys.seats_router(str(session.zid())))
    threads.start(listen, "parent")
    if part is Part.SEATS:
        # The other router passes its subscriptions on 0.1 s after the connection; until then reports would get lost.
        deadline_s = time.monotonic() + LINK_S
        while not zbus.is_received(session, keys.lesson("router", "any")) and time.monotonic() < deadline_s:
            time.sleep(POLL_S)
    _print("ready")
    while (event := events.get()) is not None:
        event()
    del watched, token
    with contextlib.suppress(
        Exception
    ):  # a client that does not read; the end of the process closes what is open
        session.close()
    return 0


def _limit_memory() -> None:
    """Limit the memory of this process to MEMORY; above it, Zenoh ends the process, and the parent starts it again."""
    if sys.platform == "linux":
        import resource  # noqa: PLC0415  # Windows has none

        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


def _print(event: str, *data: object) -> None:
    sys.stdout.write(msgspec.json.encode([event, *data]).decode() + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # Zenoh's threads may wait for a client that does not read
