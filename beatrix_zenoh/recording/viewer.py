"""The programs of Rerun, as processes: its viewer, and the tools for its files.

The command `rerun` is a Python script that starts the real program and, when killed, leaves it running. So this module
starts the program itself.
"""

from __future__ import annotations

import importlib.util
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final, Self

from beatrix_zenoh import processes
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, bad_value, wrong_usage
from beatrix_zenoh.output import typed
from beatrix_zenoh.process_groups import GROUP

HOST: Final = "127.0.0.1"
"""The viewer accepts data and commands from every program, so other computers must not reach its port."""
PORT: Final = 9876
WEB_PORT: Final = 9090
START_S: Final = 15.0
END_S: Final = 2.0
TOOL_S: Final = 600.0
"""Time limit of a tool, long enough for a recording of many hours."""
SERVER_MEMORY: Final = "200MB"
"""Memory of the viewer's server for windows that are opened later."""
SOURCE: Final = re.compile(r"^.*\.rs:\d+: ")
"""Source position that precedes Rerun's error messages; users do not need it."""
MAGIC: Final = b"RRF"
"""First bytes of a recording; a digit follows."""
FOOTER: Final = b"RRF2FOOT"
"""Marker in the last FOOTER_BYTES of a complete recording."""
FOOTER_BYTES: Final = 64
INSTALL: Final = "beatrix install rerun"


def program() -> Path:
    """Return the path of the Rerun program; raises Refused (BAD_VALUE) if it is not installed."""
    found = importlib.util.find_spec("rerun_cli")
    if found is None or found.origin is None or importlib.util.find_spec("rerun") is None:
        raise bad_value(
            f"Recordings need rerun-sdk, which is not installed: {INSTALL} (not for Intel Macs or 32-bit systems).",
        )
    folder = Path(found.origin).parent
    bundled = folder / "Rerun.app/Contents/MacOS/Rerun"
    name = "rerun.exe" if os.name == "nt" else "rerun"
    return bundled if sys.platform == "darwin" and bundled.exists() else folder / name


def environment() -> dict[str, str]:
    """Return the environment for Rerun's programs, without our log settings."""
    return {name: value for name, value in os.environ.items() if name != "RUST_LOG"}


def tool(*words: str) -> subprocess.CompletedProcess[str]:
    """Run `rerun …` on files, and return its result."""
    return subprocess.run(
        [str(program()), *words],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=TOOL_S,
        env=environment(),
        check=False,
    )


def verify(path: Path) -> str:
    """Return an empty text if a file is complete, else Rerun's error message."""
    done = tool("rrd", "verify", str(path))
    return "" if done.returncode == 0 else (done.stderr.strip() or "it could not be read").splitlines()[0]


def check_exists(path: Path) -> None:
    """Raise WrongUsage if there is no such file; the message names the recordings of its folder."""
    if path.is_file():
        return
    beside = sorted(str(other) for other in path.parent.glob("*.rrd"))
    there = f"The recordings there: {', '.join(beside)}." if beside else "`beatrix record` writes recordings."
    raise wrong_usage(f"{path}: there is no such file. {there}")


def check_recording(path: Path) -> None:
    """Raise WrongUsage for a missing file, Refused (BAD_VALUE) for one that does not begin as a recording does."""
    check_exists(path)
    try:
        with path.open("rb") as file:
            begin = file.read(len(MAGIC))
    except OSError as error:
        raise bad_value(f"{path} cannot be read: {error.strerror}. Name another file.") from error
    if begin == MAGIC:
        return
    if path.suffix.lower() == ".csv":
        raise bad_value(
            f"{path} is a motion file, not a recording (.rrd): use `{typed('beatrix', 'replay', path)}`.",
        )
    what = "is not a recording" if begin else "is empty"
    raise bad_value(f"{path} {what}. `beatrix record FILE.rrd` writes recordings.")


def complete(path: Path) -> bool:
    """Return whether a recording is complete; reads only its last bytes."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - FOOTER_BYTES))
        return FOOTER in file.read()


def answers(port: int) -> bool:
    """Return whether a program listens on this port of this computer."""
    with socket.socket() as probe:
        probe.settimeout(0.3)
        return probe.connect_ex((HOST, port)) == 0


def address(port: int) -> str:
    """Return the URL to which data for the viewer on this port are sent."""
    return f"rerun+http://{HOST}:{port}/proxy"


class Viewer:
    """A viewer process, reachable from this computer only."""

    def __init__(self, port: int, *words: str) -> None:
        """Start the viewer; `words` are further options of the program and files to show.

        Raises:
            Refused: BAD_VALUE, Rerun is not installed or the port is taken.
        """
        if answers(port):
            raise bad_value(
                f"Port {port} of this computer is taken. Choose another with --port, for example {processes.free_port()}.",
            )
        # Without this setting Rerun sends usage data to its makers.
        tool("analytics", "disable")
        self.port = port
        where = ("--bind", HOST, "--port", str(port), "--server-memory-limit", SERVER_MEMORY)
        # A file, not a pipe: nothing reads this output, and a full pipe would block the viewer.
        self._words = tempfile.TemporaryFile()  # noqa: SIM115 # closed by `end`
        self._process = subprocess.Popen(
            [str(program()), *where, *words],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=self._words,
            env=environment(),
            process_group=GROUP,
        )

    def wait_ready(self, port: int | None = None) -> None:
        """Wait until the viewer listens on its port, or on `port` if that is given.

        Raises:
            Refused: the viewer has ended; the message quotes its last output.
            NoAnswer: TIMED_OUT, the viewer does not listen within START_S.
        """
        deadline = time.monotonic() + START_S
        while not answers(port or self.port):
            if self.code is not None:
                raise bad_value(self.ending())
            if time.monotonic() > deadline:
                raise NoAnswer(Reason.TIMED_OUT, f"The Rerun viewer did not answer within {START_S:.0f} s.")
            time.sleep(0.05)

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def code(self) -> int | None:
        """Exit code of the viewer; None while it runs, 0 if its window was closed."""
        return self._process.poll()

    def end(self) -> None:
        """Terminate the viewer, or kill it after END_S. May be called twice."""
        processes.end(self._process, END_S)
        self._words.close()

    def ending(self) -> str:
        """Return a message about a viewer that has failed, with its last output."""
        if self.code is not None and self.code < 0:
            return f"The Rerun viewer was ended by signal {-self.code}."
        self._words.seek(0)
        text = self._words.read().decode("utf-8", "replace")
        lines = [line for line in text.splitlines() if line.strip()]
        reason = SOURCE.sub("", lines[-1]).strip().rstrip(".") if lines else f"code {self.code}"
        return (
            f"The Rerun viewer has ended: {reason}. On a computer without a screen, or without the graphics library Vulkan, "
            "use `beatrix view --web`."
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.end()


def repair(path: Path, into: Path) -> str:
    """Copy the readable part of a damaged file to another file; return an empty text, or the error message.

    This also joins chunks, so that long files open faster.
    """
    words: Sequence[str] = ("rrd", "optimize", "--continue-on-error", str(path), "-o", str(into))
    done = tool(*words)
    if done.returncode != 0 or not into.exists():
        return (done.stderr.strip() or "nothing in it could be read").splitlines()[-1]
    return verify(into)
