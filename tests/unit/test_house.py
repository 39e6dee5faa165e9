"""The figures about the house: floors and circles of a graph whose shape is known, and lines of code of a file."""

from __future__ import annotations

from pathlib import Path

import house


def test_floors_are_the_longest_chain_and_a_circle_is_one_floor() -> None:
    graph = {"a": {"b", "c"}, "b": {"c"}, "c": {"d"}, "d": {"c", "e"}, "e": set()}
    assert house.circles(graph) == [{"c", "d"}]
    assert house.floors(graph) == 4
    assert house.floors({"a": set(), "b": set()}) == 1


def test_rooms_are_folders_and_files_below_a_package() -> None:
    graph = {"top.one.x": {"top.two", "top.one.y"}, "top.one.y": set(), "top.two": {"other"}, "other": set()}
    assert house.inside(graph, "top", rooms=True) == {"top.one": {"top.two"}, "top.two": set()}


def test_docstrings_comments_and_empty_lines_are_not_code(tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text('"""Two\nlines."""\n\nA = 1\n"""of A"""\n# why\nB = (\n    2,\n)\n')
    assert house.code_lines(path) == 4
