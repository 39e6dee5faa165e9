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


def test_a_short_module_belongs_to_its_one_importer(tmp_path: Path) -> None:
    texts = {
        "top": "import one\ndef f():\n    import two, three\n",
        "three": "import one\n",
        "one": "",
        "two": "",
    }
    for name, text in texts.items():
        (tmp_path / f"{name}.py").write_text(text)
    assert house.short_modules({name: tmp_path / f"{name}.py" for name in texts}) == ["three", "two"]


def test_modules_that_a_table_names_exist_and_are_no_programs_of_lessons() -> None:
    root = Path(house.__file__).resolve().parent.parent
    found = house.modules(root)
    named, lessons = house.started_by_name(root), house.lesson_programs(found)
    assert {"beatrix_zenoh.cli.stop", "hw_node.app"} <= named <= found.keys() - lessons
    assert "beatrix_zenoh.lessons.library.01-hello.start" in lessons


def test_modules_do_not_import_each_other_in_a_circle() -> None:
    root = Path(house.__file__).resolve().parent.parent
    assert house.circles(house.graph_of(house.modules(root))) == []
