"""A progress bar on stderr."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol


class ProgressBar(Protocol):
    """A function that shows the completed amount, and a new title if it is given."""

    def __call__(self, completed: float, title: str | None = None) -> None: ...


@contextmanager
def progress_bar(title: str, total: float) -> Iterator[ProgressBar | None]:
    """Show a bar while the block runs; yield a function that updates it, or None if stderr is not a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

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
