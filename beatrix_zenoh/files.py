"""Files that people name, read whole: devices, pipes and what never ends are none."""

from __future__ import annotations

from pathlib import Path

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import WrongUsage


def content(path: Path, longest: int, *, called: str, form: str, nothing: str) -> bytes:
    """All of a file of at most `longest` bytes; a refusal names it as `called`, its `form` and what is never longer.

    Raises:
        OSError: it cannot be read.
        WrongUsage: BAD_VALUE, it is no regular file, or longer.
    """
    if path.exists() and not path.is_file():
        raise WrongUsage(Reason.BAD_VALUE, f"{called} is no regular file: name one in {form}.")
    with path.open("rb") as file:
        held = file.read(longest + 1)
    if len(held) > longest:
        raise WrongUsage(Reason.BAD_VALUE, f"{called} is longer than {longest} bytes: {nothing}.")
    return held
