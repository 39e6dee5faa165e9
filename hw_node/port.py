"""Serial port of a board. Only this module imports pyserial."""

from __future__ import annotations

import errno
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import serial
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from beatrix_zenoh.board.timing import BOOT_S
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import BAUD
from beatrix_zenoh.contract.errors import NoAnswer

if sys.platform == "win32":
    TerminalError = OSError
else:
    from termios import error as TerminalError  # noqa: N812 - it is a class

MEGA_USB_IDS = {(0x2341, 0x0042), (0x2341, 0x0010), (0x2A03, 0x0042), (0x2A03, 0x0010), (0x1A86, 0x7523)}
"""USB vendor and product of Arduino Mega 2560 boards and of the CH340 of their clones."""
VIRTUAL = "virtual:"
"""Port name of the virtual board."""
NO_PORT: Final = "is not a serial port: name another port with --port"
IN_USE: Final = "is used by another program, for example another `beatrix hw`: end that program first"
WHY_NOT: Final[dict[int | None, str]] = {
    errno.ENOENT: "is not there: plug the board in, or name its port with --port",
    errno.EACCES: "cannot be opened by this user: on Linux type `sudo usermod -aG dialout $USER`, then log out and in again",
    errno.EAGAIN: IN_USE,
    errno.EBUSY: IN_USE,
    **dict.fromkeys(
        (errno.ENOTTY, errno.ENOTDIR, errno.EISDIR, errno.ENXIO, errno.ENODEV, errno.ELOOP), NO_PORT
    ),
}
"""Why a port cannot be opened, and what to do, by errno value."""
NO_LINE = (errno.ENOTTY, errno.EINVAL)
"""Errno values for a terminal without modem control lines."""
WRITE_S = 0.5
RESET_S = 0.05


class SerialPort:
    """A serial device; implements the port protocol of `beatrix_zenoh.board`."""

    boot_s: Final = BOOT_S

    def __init__(self, device: str, baud: int = BAUD) -> None:
        """Open `device` for this process alone.

        Raises:
            NoAnswer: BOARD_LOST, with the reason and what to do.
        """
        self.name = device
        try:
            with as_os_error():
                self._serial = serial.serial_for_url(
                    device, baudrate=baud, timeout=0.05, write_timeout=WRITE_S, exclusive=True
                )
        except (OSError, ValueError) as error:
            raise NoAnswer(Reason.BOARD_LOST, f"{device} {why_not(error)}.") from error

    def reset_board(self) -> None:
        """Reset the board with DTR and RTS, as Arduino's tools do, and discard received bytes.

        Raises:
            NoAnswer: BOARD_LOST, the device has no reset line.
            OSError: the device is gone.
        """
        try:
            with as_os_error():
                for active in (False, True):
                    self._serial.dtr = self._serial.rts = active
                    time.sleep(RESET_S)
                self._serial.reset_input_buffer()
        except OSError as error:
            if error.errno not in NO_LINE:
                raise
            raise NoAnswer(
                Reason.BOARD_LOST,
                f"{self.name} has no reset line, so it is not the USB port of an Arduino. Name that port with --port.",
            ) from error

    def write(self, data: bytes) -> bytes:
        """Send all bytes; return b"", because replies arrive later.

        Raises OSError if the device is gone or accepts no bytes for half a second.
        """
        with as_os_error():
            self._serial.write(data)
        return b""

    def wake(self) -> None:
        """Do nothing: a real board runs by itself."""

    def read(self, timeout_s: float) -> bytes:
        """Wait up to `timeout_s` for a byte, and return all received bytes; raises OSError if the device is gone."""
        with as_os_error():
            if self._serial.timeout != timeout_s:  # avoid setting it, which configures the whole port again
                self._serial.timeout = timeout_s
            first: bytes = self._serial.read(1)
            return first + self._serial.read(self._serial.in_waiting) if first else b""

    def close(self) -> None:
        """Free the device."""
        self._serial.close()


@contextmanager
def as_os_error() -> Iterator[None]:
    """Turn the exceptions of a port that has disappeared, was closed, or accepts no bytes into OSError."""
    try:
        yield
    except TerminalError as error:
        raise OSError(*error.args) from error
    except TypeError as error:
        raise OSError("another thread has closed the port") from error
    except serial.SerialTimeoutException as error:
        raise OSError("the port accepts no bytes") from error


def why_not(error: Exception) -> str:
    """Return the end of a sentence: why the port cannot be opened, and what to do."""
    if "configure port" in str(error):
        return NO_PORT
    return WHY_NOT.get(getattr(error, "errno", None), f"cannot be opened ({error})")


def listed() -> list[str]:
    """Return a line for each serial port on USB: `board` or `other`, its name, and its description, between tabs."""
    ports = sorted(
        (port for port in list_ports.comports() if port.vid is not None), key=lambda port: port.device
    )
    return [f"{'board' if is_board(port) else 'other'}\t{port.device}\t{port.description}" for port in ports]


def is_board(port: ListPortInfo) -> bool:
    """Return whether a port is that of an Arduino Mega, or of a clone."""
    return (port.vid, port.pid) in MEGA_USB_IDS


def find(otherwise: str = "") -> str:
    """Return the port of the only board on USB; `otherwise` is appended to the message if there is no board.

    Raises:
        NoAnswer: BOARD_LOST, if there is none or more than one.
    """
    ports = list(list_ports.comports())
    boards = [port.device for port in ports if is_board(port)]
    if len(boards) == 1:
        return boards[0]
    if boards:
        raise NoAnswer(
            Reason.BOARD_LOST, f"Several boards are on USB. Choose one with --port: {', '.join(boards)}."
        )
    others = ", ".join(port.device for port in ports) or "none"
    raise NoAnswer(
        Reason.BOARD_LOST,
        f"No Arduino Mega is on USB (serial ports here: {others}). Plug it in, or name its port with "
        f"--port{otherwise}.",
    )
