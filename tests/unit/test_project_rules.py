"""Rules of the project that no linter checks: sizes, circles, generated files, and the contents of the wheel."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import house
import pytest
import release

pytestmark = pytest.mark.no_cover  # it executes no code that coverage measures

ROOT = Path(__file__).resolve().parents[2]
FILE_MAX = 300
"""Largest number of lines of code in a file: lines with a token that is neither comment nor docstring."""
FUNCTION_MAX = 50
"""Largest number of lines of a function, from `def` to its end, with its docstring."""
METHODS_MAX = 15
"""Largest number of methods of a class of the node."""
BUILT = {"_generated", "build", "dist", "demo-out"}
"""Folders with generated files only."""

DEF = re.compile(r"^( *)(?:async def|def|class) ", re.MULTILINE)


def sources(folders: str, *suffixes: str) -> list[Path]:
    """Return the source files in the folders, without generated, built and hidden ones."""
    generated = {ROOT / "firmware/beatrix/src/core/contract.h"}
    return sorted(
        path
        for top in ROOT.glob(folders)
        if top.is_dir() and not top.name.startswith(".") and top.name not in BUILT
        for path in top.rglob("*")
        if path.suffix in suffixes
        and path not in generated
        and not BUILT.intersection(path.relative_to(ROOT).parts)
    )


def cpp_code_lines(text: str) -> int:
    """Return the number of lines of a C++ file with more than a comment."""
    return sum(bool(line.partition("//")[0].strip()) for line in text.splitlines())


def long_functions(path: Path) -> Iterator[str]:
    """Yield the functions of a Python file that are longer than FUNCTION_MAX."""
    text = path.read_text(encoding="utf-8")
    marks = [(text.count("\n", 0, found.start()), len(found[1])) for found in DEF.finditer(text)]
    last = text.count("\n") + 1
    if not any(
        next((end for end, level in marks[i + 1 :] if level <= indent), last) - begin > FUNCTION_MAX
        for i, (begin, indent) in enumerate(marks)
    ):
        return  # parsing takes much longer
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            length = (node.end_lineno or node.lineno) - node.lineno + 1
            if length > FUNCTION_MAX:
                yield f"{path.relative_to(ROOT)}:{node.lineno} {node.name}: {length} lines"


def test_python_files_stay_small() -> None:
    files = sources("*", ".py")
    assert files
    counted = {
        path: house.code_lines(path)
        for path in files
        if path.read_text(encoding="utf-8").count("\n") > FILE_MAX
    }
    assert [f"{path.relative_to(ROOT)}: {n}" for path, n in counted.items() if n > FILE_MAX] == []


def test_firmware_files_stay_small() -> None:
    files = sources("firmware", ".h", ".cpp", ".c", ".ino")
    counted = {path: cpp_code_lines(path.read_text(encoding="utf-8")) for path in files}
    assert [f"{path.relative_to(ROOT)}: {n}" for path, n in counted.items() if n > FILE_MAX] == []


def test_functions_stay_short() -> None:
    assert [line for path in sources("*", ".py") for line in long_functions(path)] == []


def test_classes_of_the_node_stay_small() -> None:
    """A new part of the node is a component, not a method of an existing class."""
    counted = {
        f"{path.name} {node.name}": sum(isinstance(part, ast.FunctionDef) for part in node.body)
        for path in (ROOT / "beatrix_zenoh/node").glob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef)
    }
    assert counted
    assert {name: count for name, count in counted.items() if count > METHODS_MAX} == {}


def test_generated_files_are_up_to_date() -> None:
    command = [sys.executable, "schemas/generate.py", "--check"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_constraints_contain_no_urls() -> None:
    text = (ROOT / "constraints.txt").read_text(encoding="utf-8")
    assert "://" not in text
    assert " @ " not in text


def test_the_wheel_contains_every_file_of_its_packages_and_no_others(tmp_path: Path) -> None:
    release.build("wheel", tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    files = (path for name in house.PACKAGES for path in (ROOT / name).rglob("*") if path.is_file())
    wanted = {path.relative_to(ROOT).as_posix() for path in files if path.suffix != ".pyc"}
    assert wanted - release.contents(wheel).keys() == set()
    assert list(release.wheel_faults(wheel)) == []


def test_modules_do_not_import_each_other_in_a_circle() -> None:
    assert house.circles(house.graph_of(house.modules(ROOT))) == []
