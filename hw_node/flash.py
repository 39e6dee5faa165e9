"""`beatrix flash`: put the firmware onto an Arduino Mega, with nothing but this package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress as Bar

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.options import Json
from beatrix_zenoh.cli.verb import alone, document, note, say
from beatrix_zenoh.errors import BeatrixError, NoAnswer, WrongUsage
from hw_node import hexfile, stk500
from hw_node.port import SerialPort, find
from hw_node.stk500 import Programmer, Wire

HEX = "beatrix-mega2560.hex"
HALF = (
    "The board now holds only half of a firmware, which it will not start: run `beatrix flash` again before you use it. "
    "Its boot loader is unharmed."
)

Progress = Callable[[str, int, int], None]
"""What is being done, bytes done, bytes in all."""


def program(wire: Wire, image: bytes, tell: Progress) -> None:
    """Write, verify, start.

    Raises:
        NoAnswer: the boot loader fails; says whether the board is half-written.
    """
    programmer = Programmer(wire)
    with untouched():
        programmer.sign_on()
    try:
        for done in programmer.write(image):
            tell("Writing", done, len(image))
        for done in programmer.check(image):
            tell("Verifying", done, len(image))
    except (BeatrixError, OSError) as error:
        raise NoAnswer(Reason.BOARD_LOST, f"{error} {HALF}") from error
    except KeyboardInterrupt:
        note(HALF)
        raise
    programmer.leave()


@contextmanager
def untouched() -> Iterator[None]:
    """In here nothing has been written yet: whatever ends it says so.

    Raises:
        NoAnswer: BOARD_LOST instead of OSError.
    """
    try:
        yield
    except OSError as error:
        raise NoAnswer(
            Reason.BOARD_LOST,
            f"The port failed ({error}). Nothing was written: plug the board in and try again.",
        ) from error
    except KeyboardInterrupt:
        note("Nothing was written.")
        raise


def firmware(path: Path | None) -> bytes:
    """The image of a file, or of the firmware that came with this package.

    Raises:
        WrongUsage: it is none, or too long.
    """
    if path is None:
        with resources.as_file(resources.files("hw_node") / HEX) as shipped:
            return hexfile.read(shipped)
    image = hexfile.read(path)
    if not 0 < len(image) <= stk500.FLASH:
        raise WrongUsage(
            Reason.BAD_VALUE, f"{path} holds {len(image)} bytes; the board has room for 1 to {stk500.FLASH}."
        )
    return image


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
    image = firmware(file)
    device = port or find()
    wire = SerialPort(device, stk500.BAUD)
    try:
        note(f"{device}: waiting for the boot loader.")
        with untouched():
            wire.reset_board()
        with progress() as tell:
            program(wire, image, tell)
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
                note(f"{what} {size} bytes.")

        yield line
        return
    with Bar(console=console) as bar:
        tasks = {what: bar.add_task(what, total=None) for what in ("Writing", "Verifying")}

        def draw(what: str, done: int, size: int) -> None:
            bar.update(tasks[what], completed=done, total=size)

        yield draw


def main(words: list[str] | None = None) -> int:
    """Entry point of group `beatrix.processes`; returns the exit code."""
    return alone(flash, "beatrix flash", words)
