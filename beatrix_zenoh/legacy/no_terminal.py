"""The place of the terminal where a system has no pseudo-terminals."""

from __future__ import annotations

from pathlib import Path

from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.legacy.lines import TerminalListener


class Terminal:
    """Has the methods of the other class of this name; raises Refused (BAD_VALUE) when it is made."""

    def __init__(self, path: Path) -> None:
        raise bad_value(
            f"--legacy {path} needs a pseudo-terminal, which Windows does not have. Run this node on Linux or macOS.",
        )

    def start(self, listener: TerminalListener) -> None: ...

    def write(self, lines: bytes) -> None: ...

    def begin_answers(self) -> None: ...

    def close(self) -> None: ...
