"""Mutation testing with tools/mutate.py."""

from __future__ import annotations

import ast
from pathlib import Path

import mutate
import pytest

MODULE = '''"""A module."""

LIMIT = 3


def pick(low: int, high: int, *, up: bool = True) -> int:
    """Docstrings and f-strings are left alone: 1 < 2."""
    print(f"{low + 1}")
    if up and not low > high:
        return clip(low, high + LIMIT)
    raise ValueError(low - 1)
'''
MUTANTS = [
    (3, "3 -> 4"),
    (6, "True -> False"),
    (8, 'print(f"{low + 1}") -> pass'),
    (9, "up and not low > high -> (up or not low > high)"),
    (9, "not low > high -> (low > high)"),
    (9, "low > high -> low >= high"),
    (10, "return clip(low, high + LIMIT) -> return None"),
    (10, "high + LIMIT -> (high - LIMIT)"),
    (11, "raise ValueError(low - 1) -> pass"),
]
SWAPS = [
    ("f(a.position, a.velocity)", ["a.position, a.velocity -> a.velocity, a.position"]),
    ("f(x=g(a), y=g(b))", ["x=g(a), y=g(b) -> x=g(b), y=g(a)"]),
    ("f(a, b.c)", []),
    ("f(a, a)", []),
    ("isinstance(a, b)", []),
]


def test_a_small_function_has_the_expected_mutants() -> None:
    assert [(mutant.line, str(mutant)) for mutant in mutate.mutants(MODULE)] == MUTANTS


@pytest.mark.parametrize(("source", "swaps"), SWAPS)
def test_arguments_of_the_same_form_are_exchanged(source: str, swaps: list[str]) -> None:
    assert [str(mutant) for mutant in mutate.mutants(f"é = {source}")] == swaps


def test_every_mutant_of_a_module_compiles() -> None:
    source = (mutate.ROOT / "beatrix_zenoh/node/planner.py").read_text(encoding="utf-8")
    for mutant in mutate.mutants(source):
        assert mutant.apply(source) != source
        ast.parse(mutant.apply(source))


def files(root: Path) -> dict[str, bytes]:
    return {str(path.relative_to(root)): path.read_bytes() for path in root.rglob("*") if path.is_file()}


def test_survivors_are_printed_and_only_a_copy_is_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "things").mkdir()
    (tmp_path / "things/code.py").write_text(
        "def more(x: int) -> int:\n    return x + 7\n\n\ndef unused() -> bool:\n    return True\n"
    )
    (tmp_path / "tests/unit").mkdir(parents=True)
    (tmp_path / "tests/unit/test_code.py").write_text(
        "from things.code import more\n\n\ndef test_more() -> None:\n    assert more(1) > 7\n"
    )
    before = files(tmp_path)
    assert mutate.main(["things", "--minutes", "10"], root=tmp_path) == 0
    assert files(tmp_path) == before
    *survivors, summary = capsys.readouterr().out.splitlines()
    assert sorted(survivors) == [
        "things/code.py:2  7 -> 8",
        "things/code.py:6  True -> False",
        "things/code.py:6  return True -> return None",
    ]
    assert summary == "5 of 5 mutants tested: 2 killed, 3 survived, 0 undecided, 0 not run."
