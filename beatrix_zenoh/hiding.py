"""Files of a user that hide a module which BEATRIX needs, for example a program called `logging.py`.

Python searches the folder of the program and PYTHONPATH first, so it imports the user's file instead of the module.
This module imports only what Python itself imports at its start, because any other module may be the hidden one.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from importlib.machinery import FrozenImporter, PathFinder

OURS = ("beatrix_zenoh", "sim_node", "hw_node", "gui")


def hidden(names: Iterable[str], first: Sequence[str], later: Sequence[str]) -> dict[str, str]:
    """Return the modules of these names that a file in the folders `first` hides from `later`, each with the file.

    A second copy of a package may be there on purpose, so a folder that contains a file of the package does not hide
    it. Frozen modules cannot be hidden.
    """
    found = {}
    for name in names:
        mine = next(_files(name, first), "")
        others = [file for file in _files(name, later) if file != mine]
        if mine and others and not _is_copy(name, mine, others) and FrozenImporter.find_spec(name) is None:
            found[name] = mine
    return found


def _is_copy(name: str, mine: str, others: Sequence[str]) -> bool:
    if name in sys.stdlib_module_names:
        return False
    packages = [file for file in others if _is_package(file)]
    return not packages or (_is_package(mine) and any(_have_common_files(mine, file) for file in packages))


def _have_common_files(mine: str, other: str) -> bool:
    """Return whether the folders of two packages have a file of the same name besides their first files."""
    mine, other = os.path.dirname(mine), os.path.dirname(other)
    return any(
        os.path.isfile(os.path.join(mine, name)) for name in os.listdir(other) if not _is_package(name)
    )


def _files(name: str, folders: Iterable[str]) -> Iterator[str]:
    for folder in folders:
        spec = PathFinder.find_spec(name, [folder])
        if spec is not None and spec.origin is not None:
            yield os.path.realpath(spec.origin)


def _is_package(file: str) -> bool:
    return os.path.basename(file).startswith("__init__.")


def search_path() -> tuple[list[str], list[str]]:
    """Return the folders that Python searches before its own modules, and the others."""
    own = os.path.dirname(os.__file__)
    split = sys.path.index(own) if own in sys.path else 1
    return sys.path[:split], sys.path[split:]


def loaded() -> set[str]:
    """Return the names of all imported modules that are in no package."""
    return {name for name in list(sys.modules) if "." not in name and name != "__main__"}


def texts(name: str, file: str) -> tuple[str, str]:
    """Return what a hiding file does, and what to do."""
    whose = "Python's module" if name in sys.stdlib_module_names else "the package"
    what = os.path.dirname(file) if _is_package(file) else file
    return (
        f"{what} hides {whose} {name}, which BEATRIX needs",
        f"rename it, for example to my_{os.path.basename(what)}",
    )


def cause(error: BaseException) -> str:
    """Return the sentence about the files of the user that have caused this error of an import; empty: none has."""
    if not isinstance(error, ImportError | AttributeError):
        return ""
    named = (getattr(error, "name", None) or "").partition(".")[0]
    found = hidden(sorted({*loaded(), named} - {""}), *search_path())
    return " ".join(": ".join(texts(name, file)) + "." for name, file in found.items())
