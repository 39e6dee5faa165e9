"""A pupil's program: a Python file, or the code cells of a notebook; and the notebook that is made from a file."""

from __future__ import annotations

import ast
import hashlib
import json
import re
import warnings
from dataclasses import dataclass
from pathlib import Path

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.lessons.phrases import ErrorData, Phrase, Unmet, phrase

FORMAT = {"nbformat": 4, "nbformat_minor": 5}
KERNEL = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
LONGEST = 4_000_000
"""Largest file (bytes): a notebook contains its pictures."""
MAGIC = re.compile(r"^([ \t]*)[%!?]", re.MULTILINE)
"""Beginning of a line that only notebooks understand, for example `%matplotlib inline`."""
CELL = "# %%"
READ = 3
"""Parts of a page to read before the program: title, prediction and run."""


@dataclass(frozen=True)
class Program:
    """A program as it is checked."""

    path: Path
    """the file that the pupil has written"""
    text: str
    """the program; of a notebook the code cells, one after the other"""

    @property
    def sha256(self) -> str:
        """Hash of the text, by which a program that has passed is recognised."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    @property
    def folder(self) -> Path | None:
        """Working folder of the program as by hand: that of a notebook; None: the one in which the pupil types."""
        return self.path.parent if self.path.suffix == ".ipynb" else None

    def file(self, folder: Path) -> Path:
        """Return a file that Python can run: the pupil's own, or one written into `folder` for a notebook."""
        if self.path.suffix != ".ipynb":
            return self.path
        path = folder / f"{self.path.stem}.py"
        path.write_text(self.text, encoding="utf-8")
        return path

    def changed(self) -> bool:
        """Return whether the file is no longer the program that runs; a notebook runs as it was read."""
        return self.path.suffix != ".ipynb" and read(self.path).text != self.text

    def compile(self) -> None:
        """Raise Unmet (`runs`) if Python cannot compile the program: a check says so before it starts anything."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                compile(self.text, str(self.path), "exec", dont_inherit=True)
        except SyntaxError as error:
            raise Unmet(
                "runs", error=ErrorData(error.msg, type(error).__name__), where=self.where(error.lineno)
            ) from None
        except (ValueError, MemoryError, RecursionError):
            return  # a text that only Python itself can explain

    def where(self, line: int | None) -> Phrase | str:
        """Return the place of a line in brackets; empty: it is not known (None or 0)."""
        return phrase("where", place=self.place(line)) if line else ""

    def place(self, line: int) -> Phrase:
        """Return where a line of the program is, for the pupil: `line 12`, or `cell 3, line 2`."""
        before = self.text.splitlines()[:line] if self.path.suffix == ".ipynb" else []
        starts = [number for number, written in enumerate(before, start=1) if written == CELL]
        return (
            phrase("cell", cell=len(starts), line=line - starts[-1]) if starts else phrase("line", line=line)
        )


def read(path: Path) -> Program:
    """Read a program; raises Refused (BAD_VALUE) if that is not possible."""
    try:
        text = files.text(path, LONGEST, "Python")
        return Program(path, cells(text) if path.suffix == ".ipynb" else text)
    except OSError as error:
        raise bad_value(
            f"{path} cannot be read: {error.strerror}. `beatrix lesson start` makes it."
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise bad_value(f"{path} is not a notebook: {error}. Save it in Jupyter again.") from error


def cells(notebook: str) -> str:
    """Return the code cells of a notebook as a program; lines for the notebook itself become comments."""
    code = ["".join(cell["source"]) for cell in json.loads(notebook)["cells"] if cell["cell_type"] == "code"]
    return "\n".join(f"{CELL}\n{without_magic(text)}" for text in code) + "\n"


def without_magic(cell: str) -> str:
    """Return a code cell in which lines that Python does not understand, and notebooks do, are comments."""
    try:
        compile(cell, "cell", "exec", dont_inherit=True)
    except SyntaxError:
        return MAGIC.sub(r"\1pass  # ", cell)
    return cell


def notebook(program: str, page: str, check: str) -> str:
    """Return a notebook: the page of the lesson up to its second part, the program, the other parts, and the check.

    Args:
        program: its docstring is left out; the title of each cell becomes text, its code code.
        page: of the lesson; the page's title and each of its parts become a cell.
        check: a line for the notebook that checks the program.
    """
    head, *parts = ("\n" + program).split("\n# %%")
    before, after = (chapters := re.split(r"\n(?=## )", page))[:READ], chapters[READ:]
    found = [("markdown", text) for text in before]
    found.append(("code", _without_docstring(head)))
    for part in parts:
        title, _, code = part.partition("\n")
        found += [("markdown", f"### {title.strip()}" if title.strip() else ""), ("code", code)]
    found += [*(("markdown", text) for text in after), ("code", check)]
    cells = [
        _cell(kind, text.strip("\n"), number)
        for number, (kind, text) in enumerate(one for one in found if one[1].strip())
    ]
    return json.dumps({"cells": cells, "metadata": KERNEL, **FORMAT}, indent=1, ensure_ascii=False) + "\n"


def _without_docstring(head: str) -> str:
    if ast.get_docstring(ast.parse(head)) is None:
        return head
    first = ast.parse(head).body[0]
    return "\n".join(head.split("\n")[first.end_lineno or 0 :])


def _cell(kind: str, text: str, number: int) -> dict[str, object]:
    lines = text.splitlines(keepends=True)
    code: dict[str, object] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": lines, **code}
