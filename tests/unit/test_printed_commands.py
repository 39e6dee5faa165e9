"""Commands that the programs print can be pasted into a shell."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from beatrix_zenoh.output import typed

ROOT = Path(__file__).resolve().parents[2]


def test_words_are_quoted_for_a_shell_and_a_path_never_looks_like_an_option() -> None:
    assert (
        typed("beatrix", "view", "my lesson.rrd", Path("-x.rrd")) == "beatrix view 'my lesson.rrd' ./-x.rrd"
    )


SAFE = {"number", "found.number", "robot.name", "account.name", "name", "others", "VIRTUAL"}
"""Values that contain only letters of names and digits, or are quoted already."""
BEGUN = re.compile(r"beatrix [a-z]+[^.;`]*$")


def unquoted(tree: ast.Module) -> Iterator[str]:
    """Yield the places of values in printed commands that `typed` has not quoted."""
    for text in ast.walk(tree):
        if not isinstance(text, ast.JoinedStr):
            continue
        before = ""
        for part in text.values:
            if isinstance(part, ast.Constant):
                before += str(part.value)
            elif isinstance(part, ast.FormattedValue):
                value = ast.unparse(part.value)
                if (
                    BEGUN.search(before)
                    and value not in SAFE
                    and not value.startswith(("typed(", "'' if self._port"))
                ):
                    yield f"{text.lineno}: {value}"
                before += "X"


def test_every_printed_command_is_quoted_in_one_place() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for package in ("beatrix_zenoh", "sim_node", "hw_node", "gui")
        for path in (ROOT / package).rglob("*.py")
        if "beatrix " in (text := path.read_text(encoding="utf-8"))
        for line in unquoted(ast.parse(text))
    ]
    assert found == []
