"""The pseudo-terminal for programs of 2023: programs one after another, and the link at its path; real terminals."""

from __future__ import annotations

import contextlib
import grp
import os
import pty
import select
import signal
import stat
import subprocess
import termios
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from robots import Stage, until
from serial.tools import list_ports

from beatrix_zenoh import Refused
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.legacy.terminal import GROUP, GROUP_MODE, LINK_PREFIX, UNREAD_MAX
from hw_node.app import main

PATIENCE_S = 10.0
ANSWER = b"0123456789 0123456789 0123456789\n"
LOCAL, CONTROL = 3, 6
"""Indices in the settings of termios."""


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


# -- programs that follow each other --------------------------------------------------------------


def test_answers_that_a_program_has_not_read_are_not_given_to_the_next(port: Port) -> None:
    with port.program() as dead:
        for _ in range(UNREAD_MAX // len(ANSWER) + 1000):
            port.terminal.write(ANSWER)
        assert dead.readline() == ANSWER
    with port.program() as program:
        port.terminal.write(b"ACK\n")
        assert program.readline() == b"ACK\n"


def test_answers_to_a_program_that_has_ended_are_not_given_to_the_next(port: Port) -> None:
    with port.program():
        pass
    port.terminal.write(b"late\n")
    port.listener.begins_answers = False
    with port.program() as program:
        port.terminal.write(b"too late\n")
        port.terminal.begin_answers()
        port.terminal.write(b"ACK\n")
        assert program.readline() == b"ACK\n"


def test_leading_blanks_of_a_line_are_skipped_as_in_the_firmware(port: Port) -> None:
    with port.program() as program:
        program.write(b" @COMSTATUS\r \t @GETXPOS\r  \r@MOVRX  7\r")
        port.listener.expect("@COMSTATUS", "@GETXPOS", "@MOVRX  7")
        program.write(b" " * 200)
        program.write(b"@STOPALL\r")
        port.listener.expect("@STOPALL")


def test_half_a_line_is_not_joined_with_the_line_of_the_next_program(port: Port) -> None:
    with port.program() as dead:
        dead.write(b"@GETXPOS\r@MOVRX 100")
        port.listener.expect("@GETXPOS")
    with port.program() as program:
        program.write(b"0\r")
        port.listener.expect("0")


def test_lines_left_by_a_program_are_handed_over_before_those_of_the_next(port: Port) -> None:
    port.listener.free = threading.Semaphore(0)
    lines = [f"@MOVRX {number}" for number in range(300)]
    with contextlib.closing(Program(port.terminal.path)) as dead:
        port.listener.expect("opened")
        dead.write(b"".join(line.encode() + b"\r" for line in lines) + b"@MOV")
    port.listener.free.release()
    port.listener.expect(lines[0])
    with contextlib.closing(Program(port.terminal.path)) as program:
        program.write(b"RX 5\r")
        port.listener.free.release(2000)
        port.listener.expect(*lines[1:], "closed", "opened", "RX 5")
    port.listener.expect("closed")


def test_the_line_of_a_program_that_closes_at_once_is_received(port: Port) -> None:
    port.terminal.path.write_bytes(b"@STOPALL\r")
    port.listener.expect("opened", "@STOPALL", "closed")


def test_terminal_settings_of_a_program_are_discarded_with_it(port: Port) -> None:
    with port.program() as dead:
        subprocess.run(["stty", "sane"], stdin=dead.at, check=True)
    with port.program() as program:
        assert not termios.tcgetattr(program.at)[LOCAL] & (termios.ECHO | termios.ICANON)


def test_opening_switches_echo_off_and_changes_no_other_setting(tmp_path: Path) -> None:
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
def test_a_link_in_dev_is_listed_as_a_serial_port() -> None:
    path = Path("/dev/ttyACM97")
    with Stage() as stage:
        process = stage.simulation("bea", "--legacy", str(path))
        assert str(path) in [port.device for port in list_ports.comports()]
        process.end()
        assert not path.is_symlink()


@pytest.mark.parametrize("name", ["ttyACM0", "COM3"])
def test_the_group_of_serial_ports_may_open_the_terminal(tmp_path: Path, name: str) -> None:
    with contextlib.closing(Terminal(tmp_path / name)) as terminal:
        found = terminal.path.stat()
        try:
            group = grp.getgrnam(GROUP).gr_gid
        except KeyError:
            pytest.skip("no such group on this computer")
        if os.geteuid() and group not in os.getgroups():
            assert not found.st_mode & 0o006, "other users may not open it"
        else:
            assert found.st_gid == group
            assert stat.S_IMODE(found.st_mode) == GROUP_MODE


def test_two_nodes_never_share_a_path(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        first = stage.simulation("bea", "--legacy", str(path))
        second = stage.process(
            "hw_node", "--connect", stage.endpoint, "--port", "virtual:", "--legacy", str(path)
        )
        assert second.wait() == 1
        assert any("is used by another node" in line for line in second.lines)
        assert path.exists()
        first.end()
        assert not path.is_symlink()


def test_a_leftover_link_is_replaced_and_any_other_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        stage.simulation("bea", "--legacy", str(path)).end(signal.SIGKILL)
        assert path.is_symlink()
        stage.simulation("bea2", "--legacy", str(path)).end()
        assert not path.is_symlink()
        path.write_text("precious")
        for bad, why in ((path, "already exists"), (tmp_path / "none/COM4", "Choose a path you may write")):
            process = stage.process("sim_node", "--connect", stage.endpoint, "--legacy", str(bad))
            assert process.wait() == 1
            assert any(why in line for line in process.lines)
    assert path.read_text() == "precious"


def test_a_leftover_link_to_a_device_of_another_terminal_is_replaced(tmp_path: Path, port: Port) -> None:
    path = tmp_path / "COM5"
    path.symlink_to(LINK_PREFIX + str(port.terminal.path.resolve()))
    terminal = Terminal(path)
    assert path.resolve() != port.terminal.path.resolve()
    terminal.close()
    assert not path.is_symlink()
    with port.program():
        pass


def test_a_foreign_link_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "board"
    master, slave = pty.openpty()
    try:
        path.symlink_to(os.ttyname(slave))
        with pytest.raises(Refused, match="already exists"):
            Terminal(path)
        assert path.readlink() == Path(os.ttyname(slave))
    finally:
        os.close(master)
        os.close(slave)


def test_the_link_of_a_running_node_is_left_alone(port: Port) -> None:
    with pytest.raises(Refused, match="is used by another node"):
        Terminal(port.terminal.path)
    with port.program():
        pass


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


def test_sighup_ends_the_node_and_removes_its_link(tmp_path: Path) -> None:
    path = tmp_path / "COM4"
    with Stage() as stage:
        assert stage.simulation("bea", "--legacy", str(path)).end(signal.SIGHUP) == 0
    assert not path.is_symlink()
