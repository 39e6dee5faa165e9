"""The page about programs of 2023 names every call of pyserial that the port does not support."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial
from serial.rs485 import RS485Settings

from beatrix_zenoh.legacy.terminal import Terminal

termios = pytest.importorskip("termios", reason="the page describes Linux and macOS")

PAGE = Path(__file__).resolve().parents[2] / "docs/how-to/old-programs.md"
CALLS = """
port.baudrate = 115200; port.baudrate = 250000; port.break_condition = True; port.bytesize = 7; port.bytesize = 8
port.cancel_read(); port.cancel_write(); port.cd; port.cts; port.dsr; port.dsrdtr = True; port.dtr; port.dtr = False
port.exclusive = True; port.fd; port.fileno(); port.flush(); port.flushInput(); port.flushOutput(); port.getCD()
port.getCTS(); port.getDSR(); port.getRI(); port.getSettingsDict(); port.get_settings(); port.inWaiting(); port.in_waiting
port.apply_settings({"baudrate": 9600}); port.inter_byte_timeout = 0.1; port.interCharTimeout = 0.1; port.iread_until()
port.isOpen(); port.is_open; port.name; port.out_waiting; port.parity = "E"; port.parity = "N"
port.port; port.portstr; port.read(0); port.read_all(); port.read_until(b"x", 1); port.readable(); port.readline()
port.readinto(bytearray(1)); port.reset_input_buffer(); port.reset_output_buffer(); port.ri; port.rs485_mode
port.rs485_mode = RS485Settings(); port.rts; port.rts = False; port.rtscts = True; port.rtscts = False; port.seekable()
port.sendBreak(0.01); port.send_break(0.01); port.setDTR(False); port.setPort(port.port); port.setRTS(False)
port.set_input_flow_control(True); port.set_low_latency_mode(True); port.set_output_flow_control(True); port.stopbits = 2
port.timeout = 0; port.write(b"@COMSTATUS\\r"); port.writable(); port.writeTimeout = 1; port.write_timeout = 1
port.writelines([b"@COMSTATUS\\r"]); port.xonxoff = True; port.applySettingsDict({}); port.readall(); port.close()
"""
"""Every call of pyserial, and the settings that programs change."""


@pytest.fixture
def path(tmp_path: Path) -> Iterator[str]:
    terminal = Terminal(tmp_path / "port")
    yield str(tmp_path / "port")
    terminal.close()


def fails(path: str, call: str) -> bool:
    """Return whether a call raises an error at a port that has just been opened."""
    with contextlib.closing(serial.Serial(path, timeout=0, write_timeout=1)) as port:
        try:
            exec(call, {"port": port, "RS485Settings": RS485Settings})
        except (OSError, ValueError, io.UnsupportedOperation, termios.error):
            return True
    return False


def test_the_page_names_all_calls_that_fail_and_no_other(path: str) -> None:
    calls = [call.strip() for call in re.split(r"[;\n]", CALLS.strip())]
    table = [
        row.split("|")[1]
        for row in PAGE.read_text(encoding="utf-8").splitlines()
        if row.startswith("| `port.")
    ]
    named = [call for cell in table for call in re.findall(r"`(.+?)`", cell)]
    assert sorted(call for call in calls if fails(path, call)) == sorted(named)


@pytest.mark.parametrize(
    "options", [{}, {"rtscts": True}, {"dsrdtr": True}, {"xonxoff": True}, {"exclusive": True}]
)
def test_settings_before_the_port_is_opened_work(path: str, options: dict[str, bool]) -> None:
    with contextlib.closing(serial.Serial(None, 9600, **options)) as port:  # type: ignore[arg-type]
        port.port = path
        port.dtr = port.rts = False
        port.open()
        assert port.is_open
