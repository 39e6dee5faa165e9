"""`beatrix flash`: write the firmware to an Arduino Mega without further tools."""

from __future__ import annotations

import codecs
from binascii import unhexlify
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from beatrix_zenoh import files
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, quoted, wrong_usage
from beatrix_zenoh.output import note, print_json, say
from beatrix_zenoh.shutdown import signals_interrupt
from beatrix_zenoh.terminal.options import Json
from beatrix_zenoh.terminal.run import run_command
from hw_node import stk500
from hw_node.port import VIRTUAL, SerialPort, find
from hw_node.stk500 import FLASH, PAGE, PARKED, Programmer

SHIPPED = Path(__file__).with_name("beatrix-mega2560.hex")
"""The firmware in this package."""
DATA, END = 0, 1
SHIFTS = {2: 4, 4: 16}
"""Kinds of records with the upper part of the next addresses, and by how many bits it is shifted."""
UNUSED = (END, 3, 5)
"""Kinds without data for the flash; start addresses (3, 5) have no use on an AVR."""
SHORTEST = 5
LONGEST_FILE = 4 << 20
"""Largest size of a file (bytes): more than an image of the whole flash with one byte in each line."""


def read_hex(path: Path) -> bytes:
    """Return the image from address 0 on, 1 to FLASH bytes; gaps are 0xFF, the value of erased flash.

    Raises:
        WrongUsage: BAD_VALUE, the file is missing, or not an image for this board. The message names the invalid line.
    """
    try:
        content = files.content(path, LONGEST_FILE, "Intel HEX").removeprefix(codecs.BOM_UTF8)
    except OSError as error:
        raise wrong_usage(f"{path} cannot be read: {error.strerror}.") from error
    image, base = bytearray(), 0
    kind: int | None = DATA
    for number, line in enumerate(map(bytes.strip, content.splitlines()), start=1):
        if not line:
            continue
        kind, at, data = record(line) if kind != END else (None, 0, b"")
        begin = base + at
        if kind == DATA and len(image) <= begin <= FLASH - len(data) and (image or not begin):
            image += b"\xff" * (begin - len(image)) + data
        elif kind in SHIFTS and len(data) == 2:
            base = int.from_bytes(data, "big") << SHIFTS[kind]
        elif kind not in UNUSED:
            raise wrong_usage(
                f"{path}, line {number} is no record of Intel HEX for this board, whose addresses begin at 0, rise, and "
                f"end at {FLASH:#x}: {quoted(line.decode(errors='replace'))}.",
            )
    if kind != END or not image:
        raise wrong_usage(f"{path} is incomplete: it has no data or no end record.")
    return bytes(image)


def record(line: bytes) -> tuple[int | None, int, bytes]:
    """Return kind, address and data of one line; kind None: it is no record."""
    try:
        fields = unhexlify(line.removeprefix(b":"))
    except ValueError:
        return None, 0, b""
    whole = len(fields) >= SHORTEST and len(fields) == SHORTEST + fields[0] and not sum(fields) & 0xFF
    kind = fields[3] if whole and line.startswith(b":") else None
    return kind, int.from_bytes(fields[1:3], "big"), fields[4:-1]


UNTOUCHED = "Nothing was written."
FIRST_PAGE = (
    "The first page, where the firmware starts, was being written and is not verified: the firmware may start, fail or "
    "do nothing. Switch the motor power off and run `beatrix flash` again. The boot loader is intact."
)
HALF_WRITTEN = "The board contains an incomplete firmware and will not start it. Run `beatrix flash` again. The boot loader is intact."
COMPLETE = "The firmware is written and verified. Press the reset button to start it."


def program(port: SerialPort, image: bytes, bar: Progress) -> Iterator[str]:
    """Reset the board, write and verify the firmware, and start it; yield what describes the board from then on.

    The first page contains an endless loop until all others are verified, so a board that loses its connection or power
    meanwhile does not start the firmware. One gap remains: for a few milliseconds at the beginning and at the end the
    first page is blank, and a board that starts at that time executes the middle of the old or the new firmware.

    Raises:
        NoAnswer: the boot loader fails.
        OSError: the port fails.
    """
    programmer = Programmer(port)
    port.reset_board()
    programmer.sign_on()
    pages = [(at, image[at : at + PAGE].ljust(PAGE, b"\xff")) for at in range(0, len(image), PAGE)]
    yield FIRST_PAGE
    programmer.write(0, PARKED)
    programmer.check(0, PARKED)
    yield HALF_WRITTEN
    for at, page in bar.track(pages[1:], description="Writing"):
        programmer.write(at, page)
    for at, page in bar.track(pages[1:], description="Verifying"):
        programmer.check(at, page)
    yield FIRST_PAGE
    programmer.write(*pages[0])
    programmer.check(*pages[0])
    yield COMPLETE
    programmer.leave()


def flash(
    *,
    port: Annotated[
        str, typer.Option(metavar="PORT", help="Serial device; by default the board on USB.")
    ] = "",
    file: Annotated[
        Path,
        typer.Option(
            "--hex",
            metavar="FILE",
            help="Firmware file; by default the one in this package.",
            show_default=False,
        ),
    ] = SHIPPED,
    as_json: Json = False,
) -> None:
    """Write the firmware to the board, in about ten seconds. Hold the head: the motors switch off."""
    image, state = read_hex(file), UNTOUCHED
    if port.startswith(VIRTUAL.rstrip(":")):
        raise wrong_usage(
            f"--port {port} is a virtual board, which cannot be flashed. Name a serial port.",
        )
    console = Console(stderr=True)
    try:
        device = port or find()
        with (
            signals_interrupt(),
            closing(SerialPort(device, stk500.BAUD)) as opened,
            Progress(console=console, disable=not console.is_terminal) as bar,
        ):
            note(f"{device}: waiting for the boot loader. Hold the head: the motors switch off.")
            for now in program(opened, image, bar):
                state = now
    except OSError as error:
        text = f"The serial port failed ({error}). Check the cable. {state}"
        raise NoAnswer(Reason.BOARD_LOST, text) from error
    except NoAnswer as error:
        raise NoAnswer(error.reason, f"{error} {state}") from error
    except KeyboardInterrupt:
        note(state)
        raise
    if as_json:
        print_json({"result": True, "port": device, "bytes": len(image)})
    else:
        say(
            f"{device}: {len(image)} bytes written and verified. Home is unknown: set the head upright, enable, calibrate."
        )


def main(words: list[str] | None = None) -> int:
    """Run `beatrix flash`, and return the exit code; an entry point of group `beatrix.processes`."""
    return run_command(flash, "beatrix flash", words)
