"""`beatrix up --class`: router, simulations and page of a whole class, in one terminal on the teacher's computer."""

from __future__ import annotations

import sys
from pathlib import Path

from beatrix_zenoh import class_file, class_words
from beatrix_zenoh.class_file import Classroom
from beatrix_zenoh.classroom import provision
from beatrix_zenoh.contract.errors import wrong_usage
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.output import say, typed
from beatrix_zenoh.processes import Role, Supervisor, end_on_interrupt, watch
from beatrix_zenoh.shutdown import signals_interrupt


def run(file: Path, port: str | None) -> None:
    """Make the files of the class that are missing, and run everything until Ctrl-C.

    Args:
        file: the class file.
        port: serial port of the first robot of the class, or `virtual:`; None: no robot is served.

    Raises:
        Refused, WrongUsage: a file is invalid, or a program cannot start.
    """
    described = class_file.read(file)
    if port is not None and not described.robots:
        raise wrong_usage(f'{file} names no robot for --hw: add, for example, robots = ["bea1"].')
    folder = class_file.folder(file, described)
    provision.init(described, folder)
    account = {"BEATRIX_ACCOUNT": str((folder / "seats" / f"{TEACHER}.toml").resolve())}
    with signals_interrupt() as shutdown, Supervisor(account) as supervisor:
        supervisor.start("router", "router", "--class", str(file))
        supervisor.wait_ready()
        twin = [] if port is None else ["--name", described.robots[0]]
        words = ("--seats", str(file), *twin, "--ready")
        robots = len(described.seats) + (port is not None)
        supervisor.start("simulation", "sim", *words, role=Role.ROBOT, robots=robots)
        if port is not None:
            supervisor.start("hardware", "hw", *twin, "--port", port, role=Role.ROBOT)
        supervisor.start("page", "web", "--class", str(file), role=Role.ROBOT)
        supervisor.wait_ready()
        supervisor.new_lines()  # discards the output so far: what follows says what matters
        with end_on_interrupt():
            for line in told(described, folder, file):
                say(line)
            say(f"\nThe output of all processes is in {supervisor.folder}. Ctrl-C here ends the class.")
            watch(supervisor, shutdown)


def told(described: Classroom, folder: Path, file: Path) -> list[str]:
    """Return what the teacher does next; with the code of the page's address in a terminal."""
    lines = [
        f"Class {described.name}: {len(described.seats)} seats, each with a simulated head.",
        f"  page for all tablets    {described.page}",
        f"  words of the pupils     {folder / provision.SHEET}   (print it, one slip for each)",
        f"  your own word           {class_words.read(folder).words[TEACHER]}   (your page governs the class)",
        f"  a word that leaked      {typed('beatrix', 'classroom', 'new-word', file)} SEAT",
    ]
    if sys.stdout.isatty():
        lines.append(provision.terminal_code(described.page))
    return lines
