"""`beatrix flash`: write the firmware to an Arduino Mega without further tools."""

from __future__ import annotations

import codecs
from binascii import unhexlify
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress as Bar
from rich.progress import TaskID

from beatrix_zenoh import files
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage, quoted
from beatrix_zenoh.output import note, print_json, say
from beatrix_zenoh.shutdown import signals_interrupt
from beatrix_zenoh.terminal.options import Json
from beatrix_zenoh.terminal.run import run_command
from hw_node import stk500
from hw_node.port import VIRTUAL, SerialPort, find
from hw_node.stk500 import FLASH, PAGE, PARKED, Programmer, Wire

BLANK = 0xFF
"""Value of erased flash."""
DATA, END, SEGMENT, START_SEGMENT, HIGH, START = range(6)
LENGTHS = {END: 0, SEGMENT: 2, START_SEGMENT: 4, HIGH: 2, START: 4}
"""Number of bytes in a record of each kind. Start addresses (START_SEGMENT, START) have no use on an AVR."""
SHORTEST = 5
LONGEST_FILE = 4 << 20
"""Largest size of a file (bytes): more than an image of the whole flash with one byte in each line."""


def read_hex(path: Path) -> bytes:
    """Return the image from address 0 on, 1 to FLASH bytes; gaps are BLANK.

    Raises:
        WrongUsage: BAD_VALUE, the file is missing, or not an image for this board. The message names the invalid line.
    """
    image, base, ended = bytearray(), 0, False
    for number, line in enumerate(map(bytes.strip, content(path).splitlines()), start=1):
        if not line:
            continue
        if ended:
            raise wrong(path, number, "comes after the end record")
        kind, at, data = record(path, number, line)
        if kind == DATA and data:
            begin, end = base + at, base + at + len(data)
            if begin < len(image) or end > FLASH or (begin and not image):
                must = f"the addresses of an image begin at 0, rise, and end at {FLASH:#x} or before"
                raise wrong(path, number, f"has the addresses {begin:#x} to {end:#x}; {must}")
            image += bytes([BLANK]) * (begin - len(image)) + data
        elif kind in (SEGMENT, HIGH):
            base = int.from_bytes(data, "big") << (4 if kind == SEGMENT else 16)
        ended = kind == END
    if not ended or not image:
        raise WrongUsage(
            Reason.BAD_VALUE, f"{path} has no {'data' if ended else 'end record'}: it is incomplete."
        )
    return bytes(image)


def content(path: Path) -> bytes:
    """Return the whole file without a byte order mark; raises the errors of `read_hex`."""
    try:
        held = files.content(path, LONGEST_FILE, "Intel HEX")
    except OSError as error:
        raise WrongUsage(Reason.BAD_VALUE, f"{path} cannot be read: {error.strerror}.") from error
    return held.removeprefix(codecs.BOM_UTF8)


def record(path: Path, number: int, line: bytes) -> tuple[int, int, bytes]:
    """Return kind, address and data of one line; raises the errors of `read_hex`."""
    try:
        record = unhexlify(line.removeprefix(b":"))
    except ValueError:
        record = b""
    if (
        not line.startswith(b":")
        or len(record) < SHORTEST
        or len(record) != SHORTEST + record[0]
        or sum(record) & 0xFF
    ):
        raise wrong(path, number, f"is not a record of Intel HEX: {quoted(line.decode(errors='replace'))}")
    kind, data = record[3], record[4:-1]
    if kind != DATA and LENGTHS.get(kind) != len(data):
        raise wrong(path, number, f"has an unknown kind of record: kind {kind} with {len(data)} bytes")
    return kind, int.from_bytes(record[1:3], "big"), data


def wrong(path: Path, number: int, why: str) -> WrongUsage:
    """Return the error for a line."""
    return WrongUsage(Reason.BAD_VALUE, f"{path}, line {number} {why}.")


HEX = "beatrix-mega2560.hex"
UNTOUCHED = "Nothing was written."
FIRST_PAGE = (
    "The first page, where the firmware starts, was being written and is not verified: the firmware may start, fail or "
    "do nothing. Switch the motor power off and run `beatrix flash` again. The boot loader is intact."
)
HALF_WRITTEN = "The board contains an incomplete firmware and will not start it. Run `beatrix flash` again. The boot loader is intact."
COMPLETE = "The firmware is written and verified. Press the reset button to start it."

Progress = Callable[[str, int, int], None]
"""A function of the name of the step, the bytes done, and the total number of bytes."""
SetState = Callable[[str], None]
"""A function of the sentence that describes the board from now on."""


def program(wire: Wire, image: bytes, show_progress: Progress, now: SetState) -> None:
    """Reset the board, write and verify the firmware, and start it.

    The first page contains an endless loop until all others are verified, so a board that loses its connection or power
    meanwhile does not start the firmware. One gap remains: for a few milliseconds at the beginning and at the end the
    first page is blank, and a board that starts at that time executes the middle of the old or the new firmware.

    Raises:
        NoAnswer: the boot loader fails.
        OSError: the port fails.
    """
    programmer = Programmer(wire)
    wire.reset_board()
    programmer.sign_on()
    size = len(image)
    pages = [(at, image[at : at + PAGE].ljust(PAGE, b"\xff")) for at in range(0, size, PAGE)]
    show_progress("Writing", 0, size)
    now(FIRST_PAGE)
    programmer.write(0, PARKED)
    programmer.check(0, PARKED)
    now(HALF_WRITTEN)
    for at, page in pages[1:]:
        programmer.write(at, page)
        show_progress("Writing", min(at + PAGE, size), size)
    for at, page in pages[1:]:
        programmer.check(at, page)
        show_progress("Verifying", min(at + PAGE, size), size)
    now(FIRST_PAGE)
    programmer.write(*pages[0])
    programmer.check(*pages[0])
    now(COMPLETE)
    programmer.leave()


@contextmanager
def report_board_state() -> Iterator[SetState]:
    """Yield a function that sets the state of the board; if the block fails, report that state.

    A NoAnswer or OSError gets it in its message; it is printed before a KeyboardInterrupt.

    Raises:
        NoAnswer: the error of the block; BOARD_LOST instead of an OSError.
    """
    state = UNTOUCHED

    def now(what: str) -> None:
        nonlocal state
        state = what

    try:
        yield now
    except OSError as error:
        raise NoAnswer(
            Reason.BOARD_LOST, f"The serial port failed ({error}). Check the cable. {state}"
        ) from error
    except NoAnswer as error:
        raise NoAnswer(error.reason, f"{error} {state}") from error
    except KeyboardInterrupt:
        note(state)
        raise


def firmware(path: Path | None) -> bytes:
    """Return the image in a file, by default that of the firmware in this package.

    Raises:
        WrongUsage: the file contains no image for this board.
    """
    if path is not None:
        return read_hex(path)
    with resources.as_file(resources.files("hw_node") / HEX) as shipped:
        return read_hex(shipped)


def flash(
    *,
    port: Annotated[
        str, typer.Option(metavar="PORT", help="Serial device; by default the board on USB.")
    ] = "",
    file: Annotated[
        Path | None,
        typer.Option("--hex", metavar="FILE", help="Firmware file; by default the one in this package."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Write the firmware to the board, in about ten seconds. Hold the head: the motors switch off."""
    with signals_interrupt(), report_board_state() as now:
        image = firmware(file)
        if port.startswith(VIRTUAL.rstrip(":")):
            raise WrongUsage(
                Reason.BAD_VALUE,
                f"--port {port} is a virtual board, which cannot be flashed. Name a serial port.",
            )
        device = port or find()
        wire = SerialPort(device, stk500.BAUD)
        try:
            note(f"{device}: waiting for the boot loader. Hold the head: the motors switch off.")
            with progress() as show_progress:
                program(wire, image, show_progress, now)
        finally:
            wire.close()
    if as_json:
        print_json({"result": True, "port": device, "bytes": len(image)})
    else:
        say(
            f"{device}: {len(image)} bytes written and verified. Home is unknown: set the head upright, enable, calibrate."
        )


@contextmanager
def progress() -> Iterator[Progress]:
    """Yield a function that shows progress on stderr, if that is a terminal."""
    console = Console(stderr=True)
    with Bar(console=console, disable=not console.is_terminal) as bar:
        tasks: dict[str, TaskID] = {}

        def draw(what: str, done: int, size: int) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=size)
            bar.update(tasks[what], completed=done)

        yield draw


def main(words: list[str] | None = None) -> int:
    """Run `beatrix flash`, and return the exit code; an entry point of group `beatrix.processes`."""
    return run_command(flash, "beatrix flash", words)
