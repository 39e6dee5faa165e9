"""The search for the board's serial port, and errors of the port."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from types import SimpleNamespace

import pytest
import serial
from serial.tools import list_ports

from beatrix_zenoh import NoAnswer
from hw_node.app import main
from hw_node.port import SerialPort, find

termios = pytest.importorskip("termios", reason="Windows has none")
MEGA = SimpleNamespace(device="/dev/ttyACM0", vid=0x2341, pid=0x0042)
CLONE = SimpleNamespace(device="/dev/ttyUSB0", vid=0x1A86, pid=0x7523)
MODEM = SimpleNamespace(device="/dev/ttyS0", vid=None, pid=None)


def plugged(monkeypatch: pytest.MonkeyPatch, *ports: SimpleNamespace) -> None:
    monkeypatch.setattr(list_ports, "comports", lambda: list(ports))


def test_the_only_board_is_found_among_other_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    plugged(monkeypatch, MODEM, CLONE)
    assert find() == "/dev/ttyUSB0"


@pytest.mark.parametrize(
    ("ports", "error"),
    [
        ([MEGA, CLONE], r"--port: /dev/ttyACM0, /dev/ttyUSB0"),
        ([MODEM], r"/dev/ttyS0.*--port, or else"),
    ],
)
def test_the_error_for_no_board_or_several_lists_the_ports_and_what_to_do(
    monkeypatch: pytest.MonkeyPatch, ports: list[SimpleNamespace], error: str
) -> None:
    plugged(monkeypatch, *ports)
    with pytest.raises(NoAnswer, match=error):
        find(", or else")


def test_the_error_names_a_missing_port_a_file_or_a_port_in_use(tmp_path: Path) -> None:
    master, slave = os.openpty()
    used = SerialPort(os.ttyname(slave))
    (tmp_path / "file").write_text("")
    for device, why in (
        (tmp_path / "none", "is not there"),
        (tmp_path / "file", "is not a serial port"),
        (tmp_path, "is not a serial port"),
        (os.ttyname(slave), "is used by another program"),
    ):
        with pytest.raises(NoAnswer, match=f"{device} {why}") as refused:
            SerialPort(str(device))
        assert "Errno" not in refused.value.message
    used.close()
    os.close(master)
    os.close(slave)


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (serial.SerialException(errno.EACCES, "could not open port"), "dialout"),
        (termios.error(errno.EIO, "unplugged while it is opened"), "/dev/ttyACM0 cannot be opened"),
    ],
)
def test_the_error_for_a_port_that_cannot_be_opened_names_the_cause(
    monkeypatch: pytest.MonkeyPatch, error: Exception, message: str
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(serial, "serial_for_url", fail)
    with pytest.raises(NoAnswer, match=message):
        SerialPort("/dev/ttyACM0")


def test_ports_on_usb_are_listed_and_boards_marked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    other = SimpleNamespace(device="/dev/ttyUSB1", vid=0x0403, pid=0x6001, description="FT232R")
    mega = SimpleNamespace(**vars(MEGA), description="ttyACM0 Mega")
    plugged(monkeypatch, MODEM, other, mega)
    assert main(["--ports"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["board\t/dev/ttyACM0\tttyACM0 Mega", "other\t/dev/ttyUSB1\tFT232R"]


def test_without_a_port_on_usb_the_list_names_the_virtual_robot(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plugged(monkeypatch, MODEM)
    assert main(["--ports"]) == 0
    out, text = capsys.readouterr()
    assert (out, "beatrix hw --port virtual:" in text) == ("", True)
