"""Make a Jupyter notebook from a program whose cells begin with `# %%`."""

from __future__ import annotations

import ast
import json

FORMAT = {"nbformat": 4, "nbformat_minor": 5}
KERNEL = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def notebook(program: str) -> str:
    """Return a notebook: the program's docstring as text, the title of each cell as text, its code as code."""
    head, *parts = ("\n" + program).split("\n# %%")
    cells: list[dict[str, object]] = []
    docstring = ast.get_docstring(ast.parse(head))
    if docstring is not None:
        cells.append(_cell("markdown", f"# {docstring}", len(cells)))
        head = _without_docstring(head)
    if head.strip():
        cells.append(_cell("code", head.strip("\n"), len(cells)))
    for part in parts:
        title, _, code = part.partition("\n")
        if title.strip():
            cells.append(_cell("markdown", f"## {title.strip()}", len(cells)))
        if code.strip():
            cells.append(_cell("code", code.strip("\n"), len(cells)))
    return json.dumps({"cells": cells, "metadata": KERNEL, **FORMAT}, indent=1, ensure_ascii=False) + "\n"


def _without_docstring(head: str) -> str:
    first = ast.parse(head).body[0]
    return "\n".join(head.split("\n")[first.end_lineno or 0 :])


def _cell(kind: str, text: str, number: int) -> dict[str, object]:
    lines = text.splitlines(keepends=True)
    code: dict[str, object] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": lines, **code}
