"""`beatrix web`: a control page for Chromebooks, tablets and phones."""

from __future__ import annotations

import asyncio
import socket
from typing import Annotated

import typer

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.output import note, say
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.shutdown import Shutdown
from beatrix_zenoh.terminal.options import Connect, Name, Who
from beatrix_zenoh.terminal.run import missing, run_command

PORT = 8088
ELSEWHERE = ("192.0.2.1", 9)
"""An address outside of every local network (RFC 5737). Connecting a datagram socket to it sends nothing."""


def web(
    *,
    lan: Annotated[
        bool,
        typer.Option("--lan", help="Also serve other computers of the network; every browser needs the PIN."),
    ] = False,
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the page on this computer.")] = PORT,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
) -> None:
    """Serve a page that drives robots from a browser. Ends with Ctrl-C.

    Without --lan only this computer can open the page. With --lan each browser needs the PIN in BEATRIX_WEB_PIN, or
    the printed one if that is not set. With --name the page offers only this robot.
    """
    try:
        from gui.page.protection import PIN_VARIABLE, chosen_pin, new_pin  # noqa: PLC0415 - tornado may not be installed
        from gui.page.server import serve  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise missing("web", error) from error
    settings = resolve(name, connect, who)
    if settings.who == TEACHER:
        text = (
            "Pages of the seat `teacher` could take robots from all other seats. Choose another seat with --who or "
            "BEATRIX_WHO."
        )
        raise Refused(Reason.BAD_VALUE, text)
    pin = (chosen_pin() or new_pin()) if lan else None

    def ready(port: int) -> None:
        if pin is not None:
            note(f"PIN: the one in {PIN_VARIABLE}" if chosen_pin() else f"PIN: {pin}")
            note("Everybody in this network who knows the PIN can drive the robots. Ctrl-C ends the server.")
        say(f"ready http://{own_address() if lan else '127.0.0.1'}:{port}/")

    shutdown = Shutdown()
    shutdown.handle_signals()
    asyncio.run(serve(settings, port, only=name, pin=pin, ready=ready, shutdown=shutdown))


def own_address() -> str:
    """Return the address of this computer in its network; the loopback address if it is in no network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(ELSEWHERE)
        except OSError:
            return "127.0.0.1"
        address: str = probe.getsockname()[0]
        return address


def main(words: list[str] | None = None) -> int:
    """Run `beatrix web`, as an entry point of group `beatrix.processes`; return the exit code."""
    return run_command(web, "beatrix web", words)
