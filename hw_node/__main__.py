"""`python -m hw_node`."""

from __future__ import annotations

from beatrix_zenoh.cli.app import process
from beatrix_zenoh.cli.hurry import nothing_to_undo


def work() -> int:
    """Import the rest, serve; the exit code."""
    with nothing_to_undo():
        from hw_node.app import main  # noqa: PLC0415 - takes a moment, in which Ctrl-C is quiet
    return main()


process(work)
