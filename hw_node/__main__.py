"""`python -m hw_node`."""

from __future__ import annotations

from beatrix_zenoh.shutdown import process


def work() -> int:
    """Import the node and run it; return the exit code."""
    from hw_node.app import main  # noqa: PLC0415 - `process` handles Ctrl-C during this import

    return main()


process(work)
