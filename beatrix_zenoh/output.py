"""Results, notes, progress and JSON documents on stdout and stderr, and the exit codes."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

import msgspec

from beatrix_zenoh.contract._generated.messages import Detail, Reason

FAILED, USAGE, UNREAD = 1, 2, 141
"""Exit codes; 0 means success, shutdown.INTERRUPTED Ctrl-C. Shells use 141 if the reader has closed the pipe."""
CODES = {
    Reason.NO_ROUTER: 3,
    Reason.TIMED_OUT: 4,
    Reason.NO_ANSWER: 5,
    Reason.NO_SUCH_ROBOT: 6,
    Reason.ACCOUNT_REFUSED: 7,
    Reason.ACCESS_DENIED: 8,
    Reason.NODE_LOST: 9,
    Reason.NODE_HANGS: 10,
}
"""Exit codes of requests without an answer, one for each cause; docs/reference/exit-codes.md explains the codes."""
STDOUT = 1
GAP = "  "
PLAIN = re.compile(r"[A-Za-z0-9_+:./\\-]+" if sys.platform == "win32" else r"[A-Za-z0-9_+:./-]+")
"""A word that no shell changes. (PowerShell reads a comma as the end of an item of a list.)"""
ACTIVE = re.compile(r'["$`!“”„]|\\\\|\\$')
"""What a shell changes between double quotes."""


def exit_code(reason: Reason) -> int:
    """Return the exit code of a failure."""
    return CODES.get(reason, FAILED)


def say(text: str) -> None:
    """Print a line of the result."""
    print(printable(text), flush=True)


def note(text: str) -> None:
    """Print to stderr a line that is not part of the result."""
    print(printable(text), file=sys.stderr, flush=True)


def printable(text: str) -> str:
    """Replace control characters by question marks, except newline and tab: foreign keys may contain any."""
    return "".join(letter if letter.isprintable() or letter in "\n\t" else "?" for letter in text)


def typed(*words: str | Path) -> str:
    """Return a command as text to paste into a POSIX shell or PowerShell; a path never looks like an option."""
    text = " ".join(map(_quoted, words))
    return f"& {text}" if text[0] in "'\"" and sys.platform == "win32" else text


def _quoted(word: str | Path) -> str:
    text = f"./{word}" if isinstance(word, Path) and str(word).startswith("-") else str(word)
    if PLAIN.fullmatch(text):
        return text
    if not ACTIVE.search(text):
        return f'"{text}"'
    return "'" + text.replace("'", "''" if sys.platform == "win32" else "'\\''") + "'"


def print_json(content: Mapping[str, object]) -> None:
    """Print one JSON document on one line."""
    print(msgspec.json.encode(content).decode(), flush=True)


def print_failure(reason: Reason, message: str, detail: Detail | None = None) -> None:
    """Print a failure as JSON; `detail` is in it if there is one."""
    data = {} if detail is None else {"detail": detail}
    print_json({"result": False, "reason": reason, "message": message, **data})


def columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table as text: the heads, then a line for each row. Columns of numbers are aligned to the right."""
    lines = [list(heads), *(list(row) for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]
    right = [bool(rows) and all(numeric(row[i]) for row in rows) for i in range(len(heads))]
    return "\n".join(
        GAP.join(
            cell.rjust(width) if to_right else cell.ljust(width)
            for cell, width, to_right in zip(line, widths, right, strict=True)
        ).rstrip()
        for line in lines
    )


def numeric(cell: str) -> bool:
    """Return whether a cell begins with a number, or is the dash for a missing one."""
    return cell == "-" or cell.lstrip("+-")[:1].isdigit()


class ProgressBar(Protocol):
    """A function that shows the completed amount, and a new title if it is given."""

    def __call__(self, completed: float, title: str | None = None) -> None: ...


@contextmanager
def progress_bar(title: str, total: float) -> Iterator[ProgressBar | None]:
    """Show a bar while the block runs; yield a function that updates it, or None if stderr is not a terminal."""
    from rich.console import Console  # noqa: PLC0415 - it would delay every verb
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task(title, total=total)

        def update(completed: float, title: str | None = None) -> None:
            progress.update(task, completed=completed, description=title)

        yield update
