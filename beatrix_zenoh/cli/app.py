"""`beatrix`: what the entry point calls. Imports next to nothing: only inside `main` is Ctrl-C quiet."""

from __future__ import annotations

import sys
from collections.abc import Callable


def main() -> None:
    """As a process of its own; ends with SystemExit."""
    process(lambda: run(sys.argv[1:]))


def process(work: Callable[[], int]) -> None:
    """Do a whole process's work, which returns its exit code; ends with SystemExit."""
    try:
        code = work()
        end()
    except KeyboardInterrupt:
        code = 130  # as shells say it
    sys.exit(code)


def run(words: list[str]) -> int:
    """Run `beatrix` with these words; the exit code."""
    from beatrix_zenoh.cli.hurry import nothing_to_undo

    with nothing_to_undo():
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


def end() -> None:
    """All is done and said: while Python leaves, signals have nothing to add."""
    from beatrix_zenoh.ending import over

    over()
