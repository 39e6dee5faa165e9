"""The pseudo-terminal for programs of 2023: programs one after another, and the link at its path; real terminals."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from robots import Stage, until

from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.legacy.terminal import UNREAD_MAX
from hw_node.app import main

PATIENCE_S = 10.0
ANSWER = b"0123456789 0123456789 0123456789\n"


class Listener:
    """Records the calls of its methods; `opened` and `received` wait for the semaphore `free`."""

    def __init__(self, terminal: Terminal) -> None:
        self.events: list[str] = []
        self.free = threading.Semaphore(1_000_000)
        self.begins_answers = True
        self._terminal = terminal

    def opened(self) -> None:
        if self.begins_answers:
            self._terminal.begin_answers()
        self.events.append("opened")
        assert self.free.acquire(timeout=PATIENCE_S)

    def received(self, line: bytes) -> None:
        self.events.append(line.decode())
        assert self.free.acquire(timeout=PATIENCE_S)

    def closed(self) -> None:
        self.events.append("closed")

    def expect(self, *events: str) -> None:
        """Wait until exactly these events have arrived since the last call."""
        until(lambda: len(self.events) >= len(events), f"events {events}, not {self.events[:9]}")
        assert self.events == list(events)
        self.events.clear()


class Program:
    """Opens the terminal without changing its settings, unlike pyserial."""

    def __init__(self, path: Path) -> None:
        self.at = os.open(path, os.O_RDWR | os.O_NOCTTY)

    def write(self, data: bytes) -> None:
        assert os.write(self.at, data) == len(data)

    def readline(self) -> bytes:
        line = b""
        while not line.endswith(b"\n"):
            assert select.select([self.at], [], [], PATIENCE_S)[0], line
            line += os.read(self.at, 1)
        return line

    def close(self) -> None:
        os.close(self.at)


class Port:
    """A terminal with a listener."""

    def __init__(self, path: Path) -> None:
        self.terminal = Terminal(path)
        self.listener = Listener(self.terminal)

    @contextlib.contextmanager
    def program(self) -> Iterator[Program]:
        """Open the terminal with a program, and close it; `expect` all events in between before the block ends."""
        with contextlib.closing(Program(self.terminal.path)) as program:
            self.listener.expect("opened")
            yield program
        self.listener.expect("closed")


@pytest.fixture
def port(tmp_path: Path) -> Iterator[Port]:
    port = Port(tmp_path / "COM4")
    port.terminal.start(port.listener)
    yield port
    port.terminal.close()


def test_answers_that_a_program_has_not_read_are_not_given_to_the_next(port: Port) -> None:
    with port.program() as dead:
        for _ in range(UNREAD_MAX // len(ANSWER) + 1000):
            port.terminal.write(ANSWER)
        assert dead.readline() == ANSWER
    with port.program() as program:
        port.terminal.write(b"ACK\n")
        assert program.readline() == b"ACK\n"


def test_two_nodes_never_share_a_path(alone: Stage, tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    first = alone.hardware("bea", "virtual:", "--legacy", str(path))
    second = alone.process(
        "hw_node", "--connect", alone.endpoint, "--port", "virtual:", "--legacy", str(path)
    )
    assert second.wait() == 1
    assert any("already exists" in line for line in second.lines)
    assert path.exists()
    first.end()
    assert not path.is_symlink()


def test_a_leftover_link_is_replaced_and_any_other_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    dead = Terminal(path)
    leftover = path.readlink()
    dead.close()
    path.symlink_to(leftover)  # as if its node had been killed
    Terminal(path).close()
    assert not path.is_symlink()
    path.write_text("precious")
    for bad, why in ((path, "already exists"), (tmp_path / "none/COM4", "Choose a path you may write")):
        with pytest.raises(Refused, match=why):
            Terminal(bad)
    assert path.read_text() == "precious"


def test_a_node_removes_only_its_own_link(tmp_path: Path) -> None:
    one, other = Terminal(tmp_path / "COM4"), Terminal(tmp_path / "COM5")
    one.path.unlink()
    one.path.symlink_to(other.path.readlink())
    one.close()
    assert one.path.is_symlink()
    other.close()
    assert not other.path.is_symlink()


@pytest.mark.parametrize("through", ["board", "link"])
def test_the_port_of_the_board_is_refused_as_path(
    tmp_path: Path, through: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "board").symlink_to("/dev/null")
    (tmp_path / "link").symlink_to("board")
    assert main(["--port", str(tmp_path / "board"), "--legacy", str(tmp_path / through)]) == 2
    assert "is the board's own port" in capsys.readouterr().err
    assert (tmp_path / "board").readlink() == Path("/dev/null")


@pytest.mark.usefixtures("hangup")
def test_sighup_ends_the_node_and_removes_its_link(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        assert stage.hardware("bea", "virtual:", "--legacy", str(path)).end(signal.SIGHUP) == 0
    assert not path.is_symlink()
