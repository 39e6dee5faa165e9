"""The serial port of a board: found, opened once, kept for its life. The only importer of pyserial."""

from __future__ import annotations

import errno
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import serial
from serial.tools import list_ports

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import BAUD
from beatrix_zenoh.board.greeting import BOOT_S
from beatrix_zenoh.errors import NoAnswer

try:
    from termios import error as TerminalError  # noqa: N812 - it is a class
except ImportError:  # Windows
    TerminalError = OSError  # type: ignore[misc,assignment]

MEGA_USB_IDS = {(0x2341, 0x0042), (0x2341, 0x0010), (0x2A03, 0x0042), (0x2A03, 0x0010), (0x1A86, 0x7523)}
"""USB vendor and product of Arduino Mega 2560 boards and of the CH340 of their clones."""
VIRTUAL = "virtual:"
"""Where other ports are devices: a board in software."""
NO_PORT = (errno.ENOTTY, errno.ENOTDIR, errno.EISDIR, errno.ENXIO, errno.ENODEV, errno.ELOOP)
"""What the system says to who opens as a port what is none."""
NO_LINE = (errno.ENOTTY, errno.EINVAL)
"""What Linux and macOS say to who pulls a line of a terminal that has none."""
WRITE_S = 0.5
RESET_S = 0.05


class SerialPort:
    """Bytes to and from a serial device; the port protocol of `beatrix_zenoh.board`."""

    boot_s: Final = BOOT_S

    def __init__(self, device: str, baud: int = BAUD) -> None:
        """Open `device` for this process alone.

        Raises:
            NoAnswer: BOARD_LOST, saying why and what to do.
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
        """Pull the reset line, as Arduino's own tools do; what was said before is forgotten. OSError as `read`.

        Raises:
            NoAnswer: BOARD_LOST, this device has no such line.
        """
        try:
            with as_os_error():
                for pulled in (False, True):
                    self._serial.dtr = self._serial.rts = pulled
                    time.sleep(RESET_S)
                self._serial.reset_input_buffer()
        except OSError as error:
            if error.errno not in NO_LINE:
                raise
            raise NoAnswer(
                Reason.BOARD_LOST,
                f"{self.name} has no reset line, so it is no Arduino's USB port: name that with --port.",
            ) from error

    def write(self, data: bytes) -> None:
        """Send all of it; OSError if the device has gone or takes nothing for half a second."""
        with as_os_error():
            self._serial.write(data)

    def read(self, timeout_s: float) -> bytes:
        """What has come, waiting up to `timeout_s` for the first byte; OSError if the device has gone."""
        with as_os_error():
            if self._serial.timeout != timeout_s:  # setting it sets up the whole port again
                self._serial.timeout = timeout_s
            first: bytes = self._serial.read(1)
            return first + self._serial.read(self._serial.in_waiting) if first else b""

    def close(self) -> None:
        """Free the device."""
        self._serial.close()


@contextmanager
def as_os_error() -> Iterator[None]:
    """A port that goes just now can fail in words of its own, which pyserial lets through."""
    try:
        yield
    except TerminalError as error:
        raise OSError(*error.args) from error
    except TypeError as error:
        raise OSError("another thread has closed it just now") from error
    except serial.SerialTimeoutException as error:
        raise OSError("it takes nothing") from error


def why_not(error: Exception) -> str:
    """Why a port cannot be opened, and what to do: pyserial's own words are the system's, twice."""
    number = getattr(error, "errno", None)
    if number == errno.ENOENT:
        return "is not there: plug the board in, or name its port with --port"
    if number == errno.EACCES:
        return "may not be opened by you: on Linux type `sudo usermod -aG dialout $USER`, then log out and in again"
    if number in (errno.EAGAIN, errno.EBUSY):
        return "is used by another program: end that first, another `beatrix hw` for example"
    if number in NO_PORT or "configure port" in str(error):
        return "is no serial port: name another with --port"
    return f"cannot be opened ({error})"


def find(otherwise: str = "") -> str:
    """The one board on USB; `otherwise` says what else there is to try.

    Raises:
        NoAnswer: BOARD_LOST, if there is none, or more than one to choose from.
    """
    ports = list(list_ports.comports())
    boards = [port.device for port in ports if (port.vid, port.pid) in MEGA_USB_IDS]
    if len(boards) == 1:
        return boards[0]
    if boards:
        raise NoAnswer(
            Reason.BOARD_LOST, f"Several boards are plugged in: choose one with --port: {', '.join(boards)}."
        )
    others = ", ".join(port.device for port in ports) or "none"
    raise NoAnswer(
        Reason.BOARD_LOST,
        f"No Arduino Mega on USB (serial ports here: {others}). Plug it in, or name its port with "
        f"--port{otherwise}.",
    )
