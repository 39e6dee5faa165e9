"""`beatrix flash`: put the firmware onto an Arduino Mega, with nothing but this package."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import resources
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress as Bar
from rich.progress import TaskID

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.options import Json
from beatrix_zenoh.cli.verb import alone, document, note, say
from beatrix_zenoh.ending import SIGNALS
from beatrix_zenoh.errors import NoAnswer, WrongUsage
from hw_node import hexfile, stk500
from hw_node.port import VIRTUAL, SerialPort, find
from hw_node.stk500 import PAGE, PARKED, Programmer, Wire

HEX = "beatrix-mega2560.hex"
NOTHING = "Nothing was written."
FIRST = (
    "The page through which every start goes was just being written, and is not verified: the board may do nothing, "
    "start, or go wrong. Switch the motor power off and run `beatrix flash` again. Its boot loader is unharmed."
)
HALF = (
    "The board now holds only half of a firmware, which it will not start: run `beatrix flash` again before you use it. "
    "Its boot loader is unharmed."
)
WHOLE = "The firmware is on the board, written and verified: press its reset button to start it."

Progress = Callable[[str, int, int], None]
"""What is being done, bytes done, bytes in all."""
Phase = Callable[[str], None]
"""Takes what is true of the board from now on."""


def program(wire: Wire, image: bytes, tell: Progress, now: Phase) -> None:
    """Reset the board, write, verify, start.

    The first page is an endless loop until all others are verified: a board that loses cable or power in between does
    not start. One window cannot be closed: the few milliseconds, at the beginning and at the end, in which that page
    itself is erased and written. It is blank then, and a start runs into the middle of the old firmware or the new one.

    Raises:
        NoAnswer: the boot loader fails.
        OSError: the port fails.
    """
    programmer = Programmer(wire)
    wire.reset_board()
    programmer.sign_on()
    size = len(image)
    pages = [(at, image[at : at + PAGE].ljust(PAGE, b"\xff")) for at in range(0, size, PAGE)]
    tell("Writing", 0, size)
    now(FIRST)
    programmer.write(0, PARKED)
    programmer.check(0, PARKED)
    now(HALF)
    for at, page in pages[1:]:
        programmer.write(at, page)
        tell("Writing", min(at + PAGE, size), size)
    for at, page in pages[1:]:
        programmer.check(at, page)
        tell("Verifying", min(at + PAGE, size), size)
    now(FIRST)
    programmer.write(*pages[0])
    programmer.check(*pages[0])
    now(WHOLE)
    programmer.leave()


@contextmanager
def told_before_it_ends() -> Iterator[None]:
    """A kill or a closed window ends it as Ctrl-C does: what is half written must be said."""

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = {
        number: signal.signal(number, interrupt)
        for number in SIGNALS
        if signal.getsignal(number) is not signal.SIG_IGN
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def phases() -> Iterator[Phase]:
    """Whatever ends what is done in here says what is then true of the board.

    Raises:
        NoAnswer: also instead of OSError, as BOARD_LOST.
    """
    truth = NOTHING

    def now(what: str) -> None:
        nonlocal truth
        truth = what

    try:
        yield now
    except OSError as error:
        raise NoAnswer(
            Reason.BOARD_LOST, f"The port failed ({error}): is the board plugged in? {truth}"
        ) from error
    except NoAnswer as error:
        raise NoAnswer(error.reason, f"{error} {truth}") from error
    except KeyboardInterrupt:
        note(truth)
        raise


def firmware(path: Path | None) -> bytes:
    """The image of a file, or of the firmware that came with this package.

    Raises:
        WrongUsage: it is none.
    """
    if path is not None:
        return hexfile.read(path)
    with resources.as_file(resources.files("hw_node") / HEX) as shipped:
        return hexfile.read(shipped)


def flash(
    *,
    port: Annotated[str, typer.Option(metavar="PORT", help="Serial device; else the board on USB.")] = "",
    file: Annotated[
        Path | None,
        typer.Option("--hex", metavar="FILE", help="Another firmware than the one that came with this."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Put the firmware onto the board. Takes some ten seconds; the head must be held, for the motors go off."""
    with told_before_it_ends(), phases() as now:
        image = firmware(file)
        if port.startswith(VIRTUAL.rstrip(":")):
            raise WrongUsage(
                Reason.BAD_VALUE,
                f"--port {port} is a board in software, which has its firmware: name a serial port.",
            )
        device = port or find()
        wire = SerialPort(device, stk500.BAUD)
        try:
            note(f"{device}: waiting for the boot loader. Hold the head: the motors go off.")
            with progress() as tell:
                program(wire, image, tell, now)
        finally:
            wire.close()
    if as_json:
        document({"result": True, "port": device, "bytes": len(image)})
    else:
        say(
            f"{device}: {len(image)} bytes written and verified. Home is not known: set the head upright, enable, calibrate."
        )


@contextmanager
def progress() -> Iterator[Progress]:
    """A bar on a terminal, else a line for each half; both on stderr."""
    console = Console(stderr=True)
    if not console.is_terminal:
        begun: set[str] = set()

        def line(what: str, _done: int, size: int) -> None:
            if what not in begun:
                begun.add(what)
                with suppress(OSError):  # a reader that has gone is no reason to leave a board half-written
                    note(f"{what} {size} bytes.")

        yield line
        return
    bar = Bar(console=console)
    tasks: dict[str, TaskID] = {}

    def draw(what: str, done: int, size: int) -> None:
        if what not in tasks:
            bar.start()
            tasks[what] = bar.add_task(what, total=size)
        bar.update(tasks[what], completed=done)

    try:
        yield draw
    finally:
        bar.stop()


def main(words: list[str] | None = None) -> int:
    """Entry point of group `beatrix.processes`; returns the exit code."""
    return alone(flash, "beatrix flash", words)
