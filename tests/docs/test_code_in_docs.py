"""The Python of README and tutorial runs as printed."""

from __future__ import annotations

import re
from code import InteractiveConsole
from collections.abc import Iterator
from pathlib import Path

import pytest
from stage import Stage

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("README.md", "docs/tutorial/first-steps.md")


class Prompt(InteractiveConsole):
    """Python's prompt: what is typed there line by line must work, too."""

    errors = ""

    def write(self, data: str) -> None:
        self.errors += data


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Iterator[Stage]:
    """What `beatrix up --name bea1 --hw virtual:` starts."""
    with Stage() as made:
        made.simulation("bea1")
        made.hardware("bea1")
        monkeypatch.setenv("BEATRIX_CONNECT", made.endpoint)
        yield made


@pytest.mark.parametrize("page", PAGES)
@pytest.mark.timeout(120)
def test_python_of_page_runs(page: str, stage: Stage) -> None:
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    prompt = Prompt({"__name__": "page"})
    for block in blocks:
        for line in [*block.splitlines(), ""]:
            prompt.push(line)
    assert prompt.errors == ""
