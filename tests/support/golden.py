"""The golden file of sentences: `same("section.case", text)` compares a text with its entry in tests/golden.toml.

After a deliberate change of texts, `GOLDEN=write .venv/bin/python -m pytest TESTS` writes the entries of these tests
anew; read the difference before you commit it.
"""

from __future__ import annotations

import json
import os
import tomllib
from functools import cache
from pathlib import Path

from file_locks import lock

FILE = Path(__file__).resolve().parents[1] / "golden.toml"
HEADING = "# The sentences that people read; see tests/support/golden.py.\n"


def same(case: str, text: str) -> None:
    """Assert that a text is that of the golden file; `case` is its section, a dot, and its name."""
    section, name = case.split(".", 1)
    if os.environ.get("GOLDEN") == "write":
        write(section, name, text)
    assert text == texts()[section][name], case


@cache
def texts() -> dict[str, dict[str, str]]:
    """Return the texts of each section; read once, because reading takes 10 ms."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def write(section: str, name: str, text: str) -> None:
    """Write an entry; other processes of the same run may write others meanwhile."""
    with FILE.open("a+", encoding="utf-8") as file:
        lock(file)
        file.seek(0)
        sections: dict[str, dict[str, str]] = tomllib.loads(file.read())
        sections.setdefault(section, {})[name] = text
        file.truncate(0)
        file.write(HEADING)
        for title, entries in sorted(sections.items()):
            lines = (
                f"{json.dumps(key)} = {json.dumps(value, ensure_ascii=False)}\n"
                for key, value in sorted(entries.items())
            )
            file.write(f"\n[{json.dumps(title)}]\n{''.join(lines)}")
    texts.cache_clear()
