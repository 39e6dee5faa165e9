"""What the page about services shows of unit and compose file is in these files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs/how-to/service.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("kind", "file"), [("ini", "beatrix-hw.service"), ("yaml", "compose.yaml")])
def test_each_shown_line_is_in_the_file(kind: str, file: str) -> None:
    (shown,) = re.findall(rf"```{kind}\n(.*?)```", TEXT, re.DOTALL)
    lines = (ROOT / "deploy" / file).read_text(encoding="utf-8").splitlines()
    assert [line for line in shown.splitlines() if line not in lines] == []
