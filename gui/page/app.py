"""`beatrix web`: a control page for Chromebooks, tablets and phones."""

from __future__ import annotations

import asyncio
import socket
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from beatrix_zenoh import account, class_file
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.output import note, say
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.shutdown import Shutdown
from beatrix_zenoh.terminal.options import Connect, Name, Who
from beatrix_zenoh.terminal.run import missing, run_command

if TYPE_CHECKING:
    from gui.page.protection import Login

PORT = 8088
ELSEWHERE = ("192.0.2.1", 9)
"""An address outside of every local network (RFC 5737). Connecting a datagram socket to it sends nothing."""


def web(
    *,
    lan: Annotated[
        bool,
        typer.Option("--lan", help="Also serve other computers of the network; every browser needs the PIN."),
    ] = False,
    port: Annotated[
        int | None,
        typer.Option(min=1, max=65535, help=f"Port of the page on this computer; default: {PORT}."),
    ] = None,
    of_class: Annotated[
        Path | None,
        typer.Option(
            "--class", metavar="FILE", help="Serve the seats of this class file: each browser needs a word."
        ),
    ] = None,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
) -> None:
    """Serve a page that drives robots from a browser. Ends with Ctrl-C.

    Without --lan only this computer can open the page. With --lan each browser needs the PIN in BEATRIX_WEB_PIN, or
    the printed one if that is not set. With --name the page offers only this robot. With --class, on the teacher's
    computer, each browser that types the word of a seat gets its account and drives its robot.
    """
    try:
        from gui.page.server import serve  # noqa: PLC0415 - tornado may not be installed
    except ModuleNotFoundError as error:
        raise missing("web", error) from error
    served = _open(name, connect, who, port, lan=lan) if of_class is None else _class(of_class, port)

    def ready(_: int) -> None:
        for line in served.notes:
            note(line)
        say(f"ready {served.address}")

    shutdown = Shutdown()
    shutdown.handle_signals()
    lan = lan or of_class is not None
    asyncio.run(
        serve(served.settings, served.port, login=served.login, lan=lan, ready=ready, shutdown=shutdown)
    )


class _Served(NamedTuple):
    """What is served."""

    settings: Settings
    login: Login
    port: int
    address: str
    notes: tuple[str, ...]


def _open(name: str | None, connect: str | None, who: str | None, port: int | None, *, lan: bool) -> _Served:
    """Return a page whose browsers share a seat, or type names; raises Refused for the seat of a teacher."""
    from gui.page.protection import PIN_VARIABLE, PinLogin, chosen_pin, new_pin  # noqa: PLC0415

    settings = resolve(name, connect, who)
    own = settings.account
    if settings.who == TEACHER or (own is not None and own.role == "teacher"):
        text = (
            "Pages of the teacher could take robots from all other seats. Serve the class, where each page has the account "
            "of its seat, with `beatrix web --class class.toml`, or choose another seat with --who."
        )
        raise bad_value(text)
    chosen = chosen_pin() if lan else None
    pin = chosen or (new_pin() if lan else None)
    notes = (
        f"PIN: the one in {PIN_VARIABLE}" if chosen else f"PIN: {pin}",
        "Everybody in this network who knows the PIN can drive the robots. Ctrl-C ends the server.",
    )
    port = port or PORT
    address = f"http://{own_address() if lan else '127.0.0.1'}:{port}/"
    return _Served(settings, PinLogin(pin, name), port, address, notes if lan else ())


def _class(file: Path, port: int | None) -> _Served:
    """Return the page of a class, with the teacher's account; raises WrongUsage if a file is missing or invalid."""
    from gui.page.seats import Seats  # noqa: PLC0415

    classroom = class_file.read(file)
    folder = class_file.folder(file, classroom)
    teacher = account.load(folder / "seats" / f"{TEACHER}.toml")
    settings = Settings(classroom.seats[0], teacher.connect, TEACHER, account=teacher)
    notes = ("Each browser needs the word of a seat. Ctrl-C ends the server.",)
    return _Served(settings, Seats(classroom, folder), port or classroom.router.page, classroom.page, notes)


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
