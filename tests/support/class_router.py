"""A class with its router in a process of its own, and sessions of its accounts."""

from __future__ import annotations

import contextlib
import datetime as dt
import os
import queue
import secrets
import signal
import socket
from pathlib import Path
from typing import Any, Self

import msgspec
from patient_connections import PATIENCE_S, patiently
from robots import Process, children, until

from beatrix_zenoh import Robot, class_file
from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import Bus, Incoming
from beatrix_zenoh.classroom import certificates, provision
from beatrix_zenoh.classroom.router_file import Part
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.settings import Settings

CLI = ("-m", "beatrix_zenoh.cli")
ANSWER_S = 5.0
CLASS = """
name = "{name}"
addresses = ["{address}"]
seats = {seats}
robots = ["bea1", "bea2"]
teacher = "Ada <Lovelace>"

[router]
port = {port}
"""


class Answering:
    """A queryable that replies to each query under one concrete key, and stores the keys of the queries in `asked`."""

    def __init__(self, bus: Bus, key: str, reply_key: str = "", payload: bytes = b"real") -> None:
        self.asked: list[str] = []
        self._key, self._reply_key, self._payload = key, reply_key, payload
        bus.serve(key, self._answer)

    def _answer(self, incoming: Incoming) -> None:
        self.asked.append(incoming.key)
        incoming.reply(self._reply_key or self._concrete(incoming.key), self._payload, "text/plain")
        incoming.finish()

    def _concrete(self, asked: str) -> str:
        """Return the queryable's key, its wildcard replaced by the seat of the query, or by `zoe`."""
        own, chunks = self._key.split("/"), asked.split("/")
        seats = chunks if len(chunks) == len(own) else [*own[:-1], chunks[-1]]  # `**/stop/ana`
        return "/".join(
            seat if chunk == "*" else chunk for chunk, seat in zip(own, seats, strict=True)
        ).replace("*", "zoe")


class ReceivedKeys:
    """The keys of publications that a subscription receives."""

    def __init__(self, bus: Bus, key: str) -> None:
        self._queue: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._end = bus.subscribe(key, lambda received: self._queue.put(received.key))

    def until(self, key: str) -> list[str]:
        """Wait for this key; return all keys up to it."""
        received = []
        while True:
            received.append(self._queue.get(timeout=ANSWER_S))
            if received[-1] == key:
                return received

    def so_far(self) -> list[str]:
        """Remove and return all keys that have arrived."""
        found = []
        while not self._queue.empty():
            found.append(self._queue.get())
        return found

    def close(self) -> None:
        self._end()


def class_text(
    *,
    port: int = 7447,
    name: str = "8b",
    address: str = "127.0.0.1",
    seats: str = '["ana", "ben"]',
) -> str:
    """Return a class file with the robots bea1 and bea2 and a teacher."""
    return CLASS.format(port=port, name=name, address=address, seats=seats)


def free_ports() -> int:
    """Return a free port of this computer whose next one is free, too: a class has two routers."""
    while True:
        port = free_port()
        with contextlib.suppress(OSError, OverflowError), socket.create_server(("127.0.0.1", port + 1)):
            return port


class ClassRouter:
    """The process of a class's router: robots bea1 and bea2, a teacher, and by default the seats ana and ben.

    `options` are those of `class_text`.
    """

    def __init__(self, folder: Path, inside: tuple[str, ...] = (), **options: str) -> None:
        self._inside = inside
        self.class_file = folder / "class.toml"
        self.class_file.write_text(class_text(port=free_ports(), **options))
        self.classroom = class_file.read(self.class_file)
        self.folder = folder / self.classroom.name
        provision.init(self.classroom, self.folder)
        self.process = self.start()
        self._sessions: dict[str, Bus] = {}
        self._clients: list[Client] = []
        self._processes: list[Process] = [self.process]

    def start(self) -> Process:
        """Start the router; return when it is ready."""
        # With --with-parent it ends with its parent, even if that is killed.
        words = ("-m", "beatrix_zenoh.cli", "--with-parent", "router", "--class", str(self.class_file))
        process = Process(*words, listens=True, inside=self._inside)
        process.expect("ready")
        return process

    def start_again(self) -> None:
        """Start the router again."""
        self.process = self.start()
        self._processes.append(self.process)

    def replace(self, name: str) -> Account:
        """Delete the file of an account and run `init`, as after the loss of a card; return the old account."""
        old = self.account(name)
        self.path(name).unlink()
        made = provision.init(self.classroom, self.folder)
        assert made.changed == [name]
        return old

    def rewrite(self, old: str, new: str) -> None:
        """Change the text of the class file and run `init`."""
        text = self.class_file.read_text()
        assert old in text
        self.class_file.write_text(text.replace(old, new))
        self.classroom = class_file.read(self.class_file)
        provision.init(self.classroom, self.folder)

    def path(self, name: str) -> Path:
        """Return the path of an account's file."""
        return next(self.folder.glob(f"*s/{name}.toml"))

    def account(self, name: str) -> Account:
        return accounts.load(self.path(name))

    def former(self, name: str) -> Account:
        """Return an account as it was before it was replaced: with another certificate."""
        return certified(self.account(name))

    def session(self, name: str, program: str = "client") -> Bus:
        """Return the session of an account; each program of the account has its own."""
        label = f"{name} {program}"
        if label not in self._sessions:
            self._sessions[label] = self.open(name, label)
        return self._sessions[label]

    def open(self, name: str, label: str = "") -> Bus:
        """Open a new session of an account; the caller closes it."""
        account = self.account(name)
        return patiently(lambda: zbus.connect(account.connect, label=label, account=account))

    def client(self, name: str) -> Client:
        """Return a client of an account with a new session, which ends with this class at the latest."""
        account = self.account(name)
        client = patiently(lambda: Client(Settings("", account.connect, name, account=account)))
        self._clients.append(client)
        return client

    def robot(self, name: str, side: str, seat: str) -> Robot:
        """Return a robot through a new client of a seat."""
        return Robot(name, side, client=self.client(seat), timeout_s=PATIENCE_S)

    def settled(self, bus: Bus) -> None:
        """Wait until both routers have handled all declarations of this session."""
        account = bus._account
        assert account is not None
        seats = account.role == "student"
        other = self.session("teacher" if seats else self.classroom.seats[0], "witness")
        token = keys.seat(account.name, secrets.token_hex(4))
        end = bus.declare_token(token)
        until(lambda: token in other.tokens(token, ANSWER_S), "the other router knows the token")
        end()

    def close(self) -> None:
        for client in self._clients:
            client.close()
        for session in self._sessions.values():
            session.close()
        for process in reversed(self._processes):
            process.end(signal.SIGTERM)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def certified(account: Account, trusted: str = "", **validity: Any) -> Account:
    """Return the account with a new certificate; it checks the router against `trusted` (default: as before).

    `validity` are options of `certificates.account`.
    """
    trusted = trusted or account.authority
    own = certificates.account(f"{account.name}.01234567", trusted, **validity)
    return msgspec.structs.replace(
        account, certificate=own.certificate, key=own.key, authority=trusted, expires=dt.date.max
    )


def use_account(folder: Path, account: Path) -> None:
    """Let programs in a folder use an account."""
    (folder / "beatrix.toml").write_text(f'account = "{account}"\n')


def start_node(folder: Path, account: Path) -> Process:
    """Start a virtual robot with an account, in a folder; return when it is ready."""
    use_account(folder, account)
    node = Process(*CLI, "hw", "--port", "virtual:", folder=folder, traced=False)
    node.expect("ready")
    return node


def process_of(router: ClassRouter, part: Part) -> int:
    """Return the process id of one of the two routers."""
    return next(pid for pid, command in children(router.process.pid).items() if part.value in command.split())


def end(router: ClassRouter, part: Part, how: signal.Signals = signal.SIGKILL) -> None:
    """Kill one of the two routers, or suspend it; it is then started again."""
    os.kill(process_of(router, part), how)


def replies(bus: Bus, key: str) -> list[tuple[str, bytes]]:
    """Return key and payload of all replies to a query."""
    query = bus.query(key, timeout_s=ANSWER_S)
    found = []
    try:
        while (answer := query.next(ANSWER_S)) is not None:
            found.append((answer.key, answer.payload))
    finally:
        query.close()
    return found
