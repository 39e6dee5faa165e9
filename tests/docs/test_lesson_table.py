"""The tables of docs/lessons/README.md list every lesson, with its minutes and pages."""

from __future__ import annotations

import lesson_table


def test_the_tables_are_as_generated() -> None:
    text = lesson_table.PAGE.read_text(encoding="utf-8")
    assert lesson_table.page(text) == text, "run python tools/lesson_table.py"
