"""Read and write files.

The size of files to read is limited, because a user may name a wrong file. Editors write UTF-8 with and without a byte
order mark; both are read. Only the owner may read private files.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

from beatrix_zenoh.contract.errors import bad_value, wrong_usage

BARE = re.compile(r"[A-Za-z0-9_-]+")
"""Keys that TOML accepts without quotes."""

Stamp = tuple[int, int]
"""Time (ns since 1970) and size (bytes) of a file: others after each save."""


def stamp(path: Path) -> Stamp | None:
    """Return the stamp of a file; None if it is missing."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def from_here(path: Path) -> Path:
    """Return a path as a user types it: from the working folder, if it is inside."""
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


def content(path: Path, longest: int, form: str, called: str = "") -> bytes:
    """Return the bytes of a file of at most `longest` bytes.

    `form`: its format; `called`: its name in error messages, by default its path.

    Raises:
        OSError: the file cannot be read.
        WrongUsage: BAD_VALUE, it is not a regular file but, for example, a device, or it is longer than `longest`.
    """
    called = called or str(path)
    if path.exists() and not path.is_file():
        raise wrong_usage(f"{called} is not a regular file: choose a file in {form}.")
    with path.open("rb") as file:
        held = file.read(longest + 1)
    if len(held) > longest:
        raise wrong_usage(
            f"{called} is longer than {longest} bytes: choose a file in {form} that is shorter.",
        )
    return held


def text(path: Path, longest: int, form: str, called: str = "") -> str:
    """Return the text of a file that a person may have written, without byte order mark.

    Raises:
        OSError, WrongUsage: as `content`; also WrongUsage (BAD_VALUE) if the text is not UTF-8.
    """
    held = content(path, longest, form, called)
    with contextlib.suppress(UnicodeDecodeError):
        if 0 not in held:  # as in UTF-16
            return held.decode("utf-8-sig")
    raise wrong_usage(
        f"{called or path} is not text in UTF-8: save it again as {form} with the encoding UTF-8.",
    )


def toml(path: Path, longest: int, called: str = "") -> dict[str, object]:
    """Return the table in a TOML file; raises the errors of `text`, and WrongUsage (BAD_VALUE) for invalid TOML."""
    held = text(path, longest, "TOML", called)
    try:
        return tomllib.loads(held)
    except (ValueError, RecursionError) as error:
        raise wrong_usage(f"{called or path} cannot be read as TOML: {error}.") from error


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
            file.flush()
            os.fsync(descriptor)  # otherwise the file may be empty after a power cut
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def replace_when_complete(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`, rename it to `path` when the block ends, delete it if the block raises."""
    unfinished = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        yield unfinished
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def check_new(path: Path) -> None:
    """Raise Refused if a file exists."""
    if path.exists():
        raise bad_value(f"{path} exists and is not overwritten. Name another file, or delete it.")


@contextlib.contextmanager
def new_file(path: Path) -> Iterator[Path]:
    """As `replace_when_complete`; raises Refused if the file cannot be written."""
    try:
        with replace_when_complete(path) as unfinished:
            yield unfinished
    except OSError as error:
        raise bad_value(f"{path} cannot be written: {error.strerror or error}. Name another file.") from error


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
