"""`beatrix install`: add the packages of an extra to the environment that runs BEATRIX."""

from __future__ import annotations

import importlib.util
import shlex
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import Annotated

import typer

import beatrix_zenoh
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.output import note
from beatrix_zenoh.requirements import DISTRIBUTION


def install(
    extras: Annotated[
        list[str] | None, typer.Argument(metavar="EXTRA...", help="What to add; without it, what there is.")
    ] = None,
) -> None:
    """Install what a part of BEATRIX needs, such as gui.

    Uses uv if it is there, else pip. In a folder of the sources the versions are those of constraints.txt.
    """
    known = extras_known()
    for extra in extras or [""]:
        if extra not in known:
            what = f"{extra!r} is none of" if extra else "Choose from"
            raise typer.BadParameter(f"{what} {', '.join(known)}: for example `beatrix install gui`.")
    assert extras
    command = [*installer(), f"{DISTRIBUTION}[{','.join(extras)}]"]
    if (constraints := Path(beatrix_zenoh.__file__).parent.parent / "constraints.txt").exists():
        command += ["--constraint", str(constraints)]
    note(shlex.join(command))
    if code := subprocess.run(command, stdin=subprocess.DEVNULL, check=False).returncode:
        note(f"What is needed for {', '.join(extras)} is not installed: see above. Is there a network?")
        raise typer.Exit(code)


def extras_known() -> list[str]:
    """Return the names of all extras; raises Refused (BAD_VALUE) if BEATRIX runs without being installed."""
    try:
        return sorted(metadata.metadata(DISTRIBUTION).get_all("Provides-Extra", []))
    except metadata.PackageNotFoundError:
        raise bad_value(
            "BEATRIX runs from its sources and is not installed. Run `pip install -e .` in their folder."
        ) from None


def installer() -> list[str]:
    """Return the command that installs packages for this Python; raises Refused (BAD_VALUE) if there is none."""
    if importlib.util.find_spec("uv") is not None:
        return [sys.executable, "-P", "-m", "uv", "pip", "install", "--python", sys.executable]
    if shutil.which("uv"):
        return ["uv", "pip", "install", "--python", sys.executable]
    if importlib.util.find_spec("pip") is not None:
        return [sys.executable, "-P", "-m", "pip", "install"]
    raise bad_value("There is neither uv nor pip for this Python. Install uv, then try again.")
