"""The port for programs of 2023: programs that follow each other, and the link they find it by; real terminals."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import signal
import subprocess
import termios
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from serial.tools import list_ports
from stage import Stage, until

from beatrix_zenoh import Refused
from beatrix_zenoh.node import Terminal
from beatrix_zenoh.node.terminal import KEPT, OURS
from hw_node.app import main

PATIENCE_S = 10.0
ANSWER = b"0123456789 0123456789 0123456789\n"
LOCAL, CONTROL = 3, 6
"""Places in what termios says."""


class Listener:
    """Notes what it is told; `heard` waits while `free` is not set."""

    def __init__(self, terminal: Terminal) -> None:
        self.told: list[str] = []
        self.free = threading.Semaphore(1_000_000)
        self.greets = self.roomy = True
        self._terminal = terminal

    def opened(self) -> None:
        if self.greets:
            self._terminal.forget()
        self.told.append("opened")

    def room(self) -> bool:
        return self.roomy

    def heard(self, line: bytes) -> None:
        self.told.append(line.decode())
        assert self.free.acquire(timeout=PATIENCE_S)

    def closed(self) -> None:
        self.told.append("closed")

    def expect(self, *told: str) -> None:
        """So much, and nothing else, since it was asked last."""
        until(lambda: len(self.told) >= len(told), f"told {told}, not {self.told[:9]}")
        assert self.told == list(told)
        self.told.clear()


class Program:
    """Has opened the terminal, and nothing more: pyserial would empty and set it up as well."""

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
        """A program that comes and goes, both noticed; before it goes, the listener must have been asked for all."""
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


# -- programs that follow each other --------------------------------------------------------------


def test_what_a_program_has_not_read_is_not_for_the_next(port: Port) -> None:
    with port.program() as dead:
        for _ in range(KEPT + 1000):
            port.terminal.write(ANSWER)
        assert dead.readline() == ANSWER
    with port.program() as program:
        port.terminal.write(b"ACK\n")
        assert program.readline() == b"ACK\n"


def test_answers_to_a_program_that_has_gone_are_not_for_the_next(port: Port) -> None:
    with port.program():
        pass
    port.terminal.write(b"late\n")
    port.listener.greets = False
    with port.program() as program:
        port.terminal.write(b"too late\n")
        port.terminal.forget()
        port.terminal.write(b"ACK\n")
        assert program.readline() == b"ACK\n"


def test_half_a_line_does_not_begin_the_line_of_the_next(port: Port) -> None:
    with port.program() as dead:
        dead.write(b"@GETXPOS\r@MOVRX 100")
        port.listener.expect("@GETXPOS")
    with port.program() as program:
        program.write(b"0\r")
        port.listener.expect("0")


def test_what_a_program_has_left_is_told_apart_from_what_the_next_one_writes(port: Port) -> None:
    port.listener.free = threading.Semaphore(0)
    lines = [f"@MOVRX {number}" for number in range(700)]
    with contextlib.closing(Program(port.terminal.path)) as dead:
        port.listener.expect("opened")
        dead.write(b"".join(line.encode() + b"\r" for line in lines) + b"@MOV")
        port.listener.expect(lines[0])
    port.listener.free.release()
    port.listener.expect(lines[1])
    with contextlib.closing(Program(port.terminal.path)) as program:
        program.write(b"RX 5\r")
        port.listener.free.release(2000)
        port.listener.expect(*lines[2:], "closed", "opened", "RX 5")
    port.listener.expect("closed")


def test_a_program_of_an_instant_is_heard(port: Port) -> None:
    port.terminal.path.write_bytes(b"@STOPALL\r")
    port.listener.expect("opened", "@STOPALL", "closed")


def test_settings_of_a_program_go_with_it(port: Port) -> None:
    with port.program() as dead:
        subprocess.run(["stty", "sane"], stdin=dead.at, check=True)
    with port.program() as program:
        assert not termios.tcgetattr(program.at)[LOCAL] & (termios.ECHO | termios.ICANON)


def test_an_echo_is_switched_off_for_who_comes_and_nothing_else(tmp_path: Path) -> None:
    port = Port(tmp_path / "COM4")
    with contextlib.closing(port.terminal), contextlib.closing(Program(port.terminal.path)) as program:
        settings = termios.tcgetattr(program.at)
        settings[LOCAL] |= termios.ECHO
        settings[CONTROL][termios.VMIN], settings[CONTROL][termios.VTIME] = 0, 7
        termios.tcsetattr(program.at, termios.TCSANOW, settings)
        port.terminal.start(port.listener)
        port.listener.expect("opened")
        settings[LOCAL] &= ~termios.ECHO
        assert termios.tcgetattr(program.at) == settings


# -- the link -------------------------------------------------------------------------------------


@pytest.mark.skipif(not os.access("/dev", os.W_OK), reason="only an administrator may put a link into /dev")
def test_a_link_in_dev_is_found_by_programs_that_look_for_ports() -> None:
    path = Path("/dev/ttyACM97")
    with Stage() as stage:
        process = stage.simulation("bea", "--legacy", str(path))
        assert str(path) in [port.device for port in list_ports.comports()]
        process.end()
        assert not path.is_symlink()


def test_two_nodes_never_share_a_path(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        first = stage.simulation("bea", "--legacy", str(path))
        second = stage.process(
            "hw_node", "--connect", stage.endpoint, "--port", "virtual:", "--legacy", str(path)
        )
        assert second.wait(20) == 1
        assert any("belongs to another node" in line for line in second.lines)
        assert path.exists()
        first.end()
        assert not path.is_symlink()


def test_a_link_left_behind_is_replaced_and_anything_else_refused(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        stage.simulation("bea", "--legacy", str(path)).end(signal.SIGKILL)
        assert path.is_symlink()
        stage.simulation("bea2", "--legacy", str(path)).end()
        assert not path.is_symlink()
        path.write_text("precious")
        for bad, why in ((path, "is there already"), (tmp_path / "none/COM4", "Choose a path you may write")):
            process = stage.process("sim_node", "--connect", stage.endpoint, "--legacy", str(bad))
            assert process.wait(20) == 1
            assert any(why in line for line in process.lines)
    assert path.read_text() == "precious"


def test_a_link_left_behind_whose_number_somebody_else_has_now_is_replaced(
    tmp_path: Path, port: Port
) -> None:
    path = tmp_path / "COM5"
    path.symlink_to(OURS + str(port.terminal.path.resolve()))
    terminal = Terminal(path)
    assert path.resolve() != port.terminal.path.resolve()
    terminal.close()
    assert not path.is_symlink()
    with port.program():
        pass


def test_a_link_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "board"
    master, slave = pty.openpty()
    try:
        path.symlink_to(os.ttyname(slave))
        with pytest.raises(Refused, match="is there already"):
            Terminal(path)
        assert path.readlink() == Path(os.ttyname(slave))
    finally:
        os.close(master)
        os.close(slave)


def test_a_link_that_another_node_lives_by_is_left_alone(port: Port) -> None:
    with pytest.raises(Refused, match="belongs to another node"):
        Terminal(port.terminal.path)
    with port.program():
        pass


def test_a_node_takes_away_its_own_link_only(tmp_path: Path) -> None:
    one, other = Terminal(tmp_path / "COM4"), Terminal(tmp_path / "COM5")
    one.path.unlink()
    one.path.symlink_to(other.path.readlink())
    one.close()
    assert one.path.is_symlink()
    other.close()
    assert not other.path.is_symlink()


@pytest.mark.parametrize("through", ["board", "link"])
def test_the_boards_own_port_is_no_place_for_it(
    tmp_path: Path, through: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "board").symlink_to("/dev/null")
    (tmp_path / "link").symlink_to("board")
    assert main(["--port", str(tmp_path / "board"), "--legacy", str(tmp_path / through)]) == 2
    assert "is the board's own port" in capsys.readouterr().err
    assert (tmp_path / "board").readlink() == Path("/dev/null")


def test_a_window_that_is_closed_ends_the_node_and_its_link(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        assert stage.simulation("bea", "--legacy", str(path)).end(signal.SIGHUP) == 0
    assert not path.is_symlink()
