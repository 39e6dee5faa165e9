"""The table of promises in tests/README.md: each test that it names exists."""

from __future__ import annotations

import ast
import re
from pathlib import Path

TESTS = Path(__file__).parents[1]
ROW = re.compile(r"^\| .+ \| `(\S+)::(\w+)` \|$", re.MULTILINE)


def test_each_promise_has_its_test() -> None:
    rows: list[tuple[str, str]] = ROW.findall((TESTS / "README.md").read_text(encoding="utf-8"))
    assert len(rows) > 50
    missing = []
    for path, name in rows:
        nodes = ast.parse((TESTS / path).read_text(encoding="utf-8")).body
        names = {getattr(node, "name", "") for node in nodes}
        names |= {
            target.id
            for node in nodes
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        if name not in names:
            missing.append(f"{path}::{name}")
    assert not missing, "name the test that covers the promise now"
