"""Files of a user that hide a module which BEATRIX needs, for example a program called `logging.py`.

Python searches the folder of the program and PYTHONPATH first, so it imports the user's file instead of the module, or
a package that this Python or BEATRIX cannot use. This module imports only what Python itself imports at its start,
because any other module may be the hidden one.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from importlib.machinery import FrozenImporter, PathFinder

OURS = ("beatrix_zenoh", "sim_node", "hw_node", "gui")


def hidden(names: Iterable[str], first: Sequence[str], later: Sequence[str]) -> dict[str, str]:
    """Return the modules of these names that a file in the folders `first` hides from `later`, each with the file.

    A second copy of a package may be there on purpose, so a package does not hide one, nor does one that is part of a
    copy of BEATRIX. Frozen modules cannot be hidden.
    """
    found = {}
    for name in names:
        mine = next(_files(name, first), "")
        others = _others(name, mine, later)
        if mine and others and not _is_copy(name, mine, others) and FrozenImporter.find_spec(name) is None:
            found[name] = mine
    return found


def _is_copy(name: str, mine: str, others: Sequence[str]) -> bool:
    if name in sys.stdlib_module_names:
        return False
    if name in OURS and _is_package(mine):
        return os.path.isdir(os.path.join(os.path.dirname(mine), os.pardir, OURS[0]))
    return _is_package(mine) or not any(map(_is_package, others))


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
        f"rename it, for example to my_{os.path.basename(what)}, or take it out of PYTHONPATH",
    )


def cause(error: BaseException) -> str:
    """Return the sentence about the file or package of the user that has caused this error; empty: none has."""
    first, later = search_path()
    named = set(_named(error, first))
    imports = isinstance(error, ImportError | AttributeError)
    found = hidden(loaded() | named, first, later) if imports else {}
    if not found:
        if (named or imports) and (why := unfit(first, core=False)):
            return why
        found = {name: next(_files(name, first), "") for name in named - {*OURS}}
        found = {name: mine for name, mine in found.items() if mine and any(_others(name, mine, later))}
    names = sorted(found.keys() & named or found)
    return " ".join(": ".join(texts(name, found[name])) + "." for name in names)


def _others(name: str, mine: str, folders: Sequence[str]) -> list[str]:
    return [file for file in _files(name, folders) if file != mine]


def unfit(folders: Iterable[str], *, core: bool = True) -> str:
    """Return the sentence about packages in these folders that BEATRIX cannot use; empty: none.

    `core`: only those that every program of BEATRIX needs.
    """
    found = [folder for folder in folders if any(name.endswith("-info") for name in _listed(folder))]
    if not found:
        return ""  # the usual case, which must not delay a program
    from beatrix_zenoh import requirements  # noqa: PLC0415 - imports modules that may be hidden

    return " ".join(": ".join(both) + "." for both in requirements.misfits(found, core=core).values())


def _listed(folder: str) -> list[str]:
    try:
        return os.listdir(folder or os.curdir)
    except OSError:
        return []


def _named(error: BaseException, first: Sequence[str]) -> Iterator[str]:
    """Yield the names of the modules that an error tells of, or that were imported from these folders when it was raised."""
    of = error.obj if isinstance(error, AttributeError) else None
    for name in (getattr(of, "__name__", None), getattr(error, "name", None)):
        if isinstance(name, str):
            yield name.partition(".")[0]
    files = [getattr(error, "filename", None), getattr(error, "path", None)]
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_name == "<module>":
            files.append(trace.tb_frame.f_code.co_filename)
        trace = trace.tb_next
    for file in files:
        for folder in first:
            start = os.path.join(folder, "")
            if folder and isinstance(file, str) and file.startswith(start):
                yield file[len(start) :].split(os.sep)[0].partition(".")[0]
