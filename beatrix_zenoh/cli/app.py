"""`beatrix`: what the entry point calls."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence


def main() -> None:
    """As a process of its own; ends with SystemExit."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without a degree sign is no reason to fail
    sys.exit(run(sys.argv[1:]))


def run(words: Sequence[str]) -> int:
    """Run `beatrix` with these words; the exit code."""
    try:
        from beatrix_zenoh.cli import verb
        from beatrix_zenoh.cli.catalogue import application

        app = application(words)
    except ModuleNotFoundError as error:
        if error.name not in ("typer", "rich"):
            raise
        sys.stderr.write(
            f"The command line needs {error.name}, which is not installed: "
            'pip install ".[cli]" in the folder of BEATRIX\n'
        )
        return 1
    return verb.run(app, words, "beatrix")
