"""Read and write files.

The size of files to read is limited, because a user may name a wrong file. Only the owner may read private files.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import msgspec

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import WrongUsage

BARE = re.compile(r"[A-Za-z0-9_-]+")
"""Keys that TOML accepts without quotes."""


def content(path: Path, longest: int, *, called: str, form: str, nothing: str) -> bytes:
    """Return the bytes of a file of at most `longest` bytes.

    `called`: name of the file in error messages; `form`: its format; `nothing`: why no valid file is longer.

    Raises:
        OSError: the file cannot be read.
        WrongUsage: BAD_VALUE, it is not a regular file but, for example, a device, or it is longer than `longest`.
    """
    if path.exists() and not path.is_file():
        raise WrongUsage(Reason.BAD_VALUE, f"{called} is not a regular file: choose a file in {form}.")
    with path.open("rb") as file:
        held = file.read(longest + 1)
    if len(held) > longest:
        raise WrongUsage(Reason.BAD_VALUE, f"{called} is longer than {longest} bytes: {nothing}.")
    return held


def unknown_fields(table: Mapping[str, object], kind: type[msgspec.Struct]) -> list[str]:
    """Return the names in a TOML table that are not fields of `kind`, sorted."""
    return sorted(set(table) - {field.encode_name for field in msgspec.structs.fields(kind)})


def user_folder(platform: str = sys.platform, environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder of a user's BEATRIX settings on a platform.

    It is `beatrix` in $XDG_CONFIG_HOME, %APPDATA% or ~/Library/Application Support.
    """
    if platform == "win32":
        home = environment.get("APPDATA") or str(Path.home() / "AppData/Roaming")
    elif platform == "darwin":
        home = str(Path.home() / "Library/Application Support")
    else:
        home = environment.get("XDG_CONFIG_HOME") or str(Path.home() / ".config")
    return Path(home) / "beatrix"


def write_private(path: Path, text: str) -> None:
    """Write a file of mode 0600 in one step: a reader gets all of the old content or all of the new."""
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-")  # mkstemp sets mode 0600
    try:
        with open(descriptor, "w", encoding="utf-8") as file:  # noqa: PTH123  # Path.open takes no descriptor
            file.write(text)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def private_file(text: str) -> Iterator[Path]:
    """Yield the path of a temporary file of mode 0600, for libraries that read secrets from files only."""
    descriptor, name = tempfile.mkstemp(prefix="beatrix-")
    try:
        with open(descriptor, "w", encoding="utf-8") as file:  # noqa: PTH123  # Path.open takes no descriptor
            file.write(text)
        yield Path(name)
    finally:
        Path(name).unlink()


def toml_text(table: Mapping[str, object]) -> str:
    """Return a table as TOML: first a line for each text, number, boolean and list of texts, then the inner tables."""
    lines, tables = [], []
    for key, value in table.items():
        name = key if BARE.fullmatch(key) else json.dumps(key)
        if isinstance(value, Mapping):
            tables.append(f"\n[{name}]\n{toml_text(value)}")
        else:
            lines.append(f"{name} = {json.dumps(value, ensure_ascii=False)}\n")
    return "".join(lines + tables)
