"""The size and the shape of the house, as a table: `python tools/house.py`, or `… house.py FOLDER` for another clone.

A line of code has a token that is neither comment nor docstring. Imports for types only count, those inside functions
only for short modules, which belong to their one importer. A floor is one module (or room) of the longest chain of
imports; modules of a circle share one floor.
"""

from __future__ import annotations

import ast
import sys
import tokenize
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from graphlib import TopologicalSorter
from pathlib import Path

PACKAGES = ("beatrix_zenoh", "sim_node", "hw_node", "gui")
"""Top-level names of the wheel. Another name could hide a student's own file."""
LAYOUT = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
}
SHORT = 50
"""Lines of code below which a module is short."""
Graph = dict[str, set[str]]


def docstring_lines(tree: ast.AST) -> set[int]:
    """Return the numbers of the lines of all docstrings, those of attributes included."""
    found: set[int] = set()
    for node in ast.walk(tree):
        for statement in getattr(node, "body", []) if not isinstance(node, ast.Lambda | ast.IfExp) else []:
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                found.update(range(statement.lineno, (statement.end_lineno or statement.lineno) + 1))
    return found


def code_lines(path: Path) -> int:
    """Return the number of lines of code in a file."""
    left_out = docstring_lines(ast.parse(path.read_text(encoding="utf-8")))
    with tokenize.open(path) as file:
        tokens = [token for token in tokenize.generate_tokens(file.readline) if token.type not in LAYOUT]
    lines = {line for token in tokens for line in range(token.start[0], token.end[0] + 1)}
    return len(lines - left_out)


def modules(root: Path) -> dict[str, Path]:
    """Return the files of the packages by the names of their modules."""
    found = {}
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def at_import(tree: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Yield the imports that are not inside a function."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield from at_import(node)


def imported(imports: Iterable[ast.AST], known: Mapping[str, Path]) -> set[str]:
    """Return the modules of the packages that some imports name."""
    found: set[str] = set()
    for node in imports:
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module in known:
            for alias in node.names:
                name = f"{node.module}.{alias.name}"
                found.add(name if name in known else str(node.module))
    return found


def graph_of(found: Mapping[str, Path]) -> Graph:
    """Return what each module imports."""
    return {
        name: imported(at_import(ast.parse(path.read_text(encoding="utf-8"))), found) - {name}
        for name, path in found.items()
    }


def short_modules(found: Mapping[str, Path]) -> list[str]:
    """Return the modules with fewer than SHORT lines of code that one module imports, at import or inside a function."""
    importers = Counter(
        other
        for name, path in found.items()
        for other in imported(ast.walk(ast.parse(path.read_text(encoding="utf-8"))), found) - {name}
    )
    return [name for name, path in found.items() if importers[name] == 1 and code_lines(path) < SHORT]


def lesson_programs(found: Mapping[str, Path]) -> set[str]:
    """Return the files of the library of lessons, which the house reads or runs and does not import."""
    return {name for name in found if name.startswith("beatrix_zenoh.lessons.library.")}


def started_by_name(root: Path) -> set[str]:
    """Return the modules whose names are in a table and not in an import: entry points, and `MODULES` of the command line."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    tables = [project["scripts"], *project["entry-points"].values()]
    programs = {entry.partition(":")[0] for table in tables for entry in table.values()}
    tree = ast.parse((root / "beatrix_zenoh/cli/verbs.py").read_text(encoding="utf-8"))
    (modules,) = [
        node.value.keys
        for node in tree.body
        if isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Dict)
        and ast.unparse(node.targets[0]) == "MODULES"
    ]
    return programs | {
        f"beatrix_zenoh.{ast.literal_eval(module)}" for module in modules if module is not None
    }


def circles(graph: Graph) -> list[set[str]]:
    """Return the sets of modules that import each other, directly or through others."""

    def reached(begin: str) -> set[str]:
        seen, waiting = set(), list(graph[begin])
        while waiting:
            name = waiting.pop()
            if name not in seen:
                seen.add(name)
                waiting.extend(graph[name])
        return seen

    reach = {name: reached(name) for name in graph}
    found: list[set[str]] = []
    for name in graph:
        if name in reach[name] and not any(name in circle for circle in found):
            found.append({other for other in reach[name] if name in reach[other]})
    return found


def floors(graph: Graph) -> int:
    """Return the number of modules in the longest chain of imports; a circle counts as one module."""
    of = {name: min(circle) for circle in circles(graph) for name in circle}
    merged: Graph = defaultdict(set)
    for name, others in graph.items():
        own = of.get(name, name)
        merged[own] |= {of.get(other, other) for other in others} - {own}
    level: dict[str, int] = {}
    for name in TopologicalSorter(merged).static_order():
        level[name] = 1 + max((level[other] for other in merged.get(name, ())), default=0)
    return max(level.values(), default=0)


def inside(graph: Graph, room: str, *, rooms: bool) -> Graph:
    """Return the part of the graph below a package; with `rooms`, its folders and files instead of modules."""
    depth = room.count(".") + 2
    part: Graph = defaultdict(set)
    for name, others in graph.items():
        for other in {name, *others}:
            if name.startswith(f"{room}.") and other.startswith(f"{room}."):
                one, two = (".".join(m.split(".")[:depth]) if rooms else m for m in (name, other))
                part[one] |= {two} - {one}
                part[two] |= set()
    return dict(part)


def classes(paths: Iterable[Path]) -> Iterator[tuple[str, int, int]]:
    """Yield name, length in lines and number of methods of each class at the top of a module."""
    for path in paths:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                methods = sum(isinstance(part, ast.FunctionDef) for part in node.body)
                yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1, methods


def figures(root: Path) -> Iterator[tuple[str, object]]:
    """Yield the rows of the table."""
    found = modules(root)
    graph = graph_of(found)
    own = [path for path in found.values() if "_generated" not in path.parts]
    total = 0
    for package in PACKAGES:
        lines = sum(code_lines(path) for name, path in found.items() if name.split(".")[0] == package)
        total += lines
        yield f"lines of code, {package}", lines
    yield "lines of code, the four packages", total
    yield "lines of code, generated", total - sum(map(code_lines, own))
    lessons = lesson_programs(found)
    yield (
        "lines of code, programs of lessons, which are data",
        sum(code_lines(found[name]) for name in lessons),
    )
    yield "lines of code, tests", sum(map(code_lines, (root / "tests").rglob("*.py")))
    yield "files", len(found)
    importers = Counter(other for others in graph.values() for other in others)
    named = started_by_name(root)
    named |= {name for name in found if name.endswith(".__main__")}
    yield "modules started by name", len(named)
    packages = {name for name, path in found.items() if path.stem == "__init__"}
    counted = graph.keys() - lessons - named - packages
    yield "other modules with at most one importer", sum(importers[name] <= 1 for name in counted)
    yield "short modules with one importer", len(short_modules(found))
    yield "rooms and floors of beatrix_zenoh", _size(inside(graph, "beatrix_zenoh", rooms=True))
    for room in ("node", "client"):
        yield f"files and floors of {room}", _size(inside(graph, f"beatrix_zenoh.{room}", rooms=False))
    known = list(classes(own))
    names = Counter(name for name, _, _ in known if not name.startswith("_"))
    yield "names of more than one class", sum(count > 1 for count in names.values())
    yield "circles", len(circles(graph))
    name, lines, methods = max(known, key=lambda row: row[1])
    yield "longest class", f"{name}, {lines} lines, {methods} methods"


def _size(graph: Graph) -> str:
    return f"{len(graph)} on {floors(graph)}"


def main(root: Path) -> None:
    """Print the table, then circles and names of more than one class."""
    for title, figure in figures(root):
        print(f"{title:<51}{figure}")
    found = modules(root)
    for circle in circles(graph_of(found)):
        print("circle:", ", ".join(sorted(circle)))
    own = [path for path in found.values() if "_generated" not in path.parts]
    names = Counter(name for name, _, _ in classes(own) if not name.startswith("_"))
    print("classes:", ", ".join(f"{name} {count}" for name, count in names.most_common() if count > 1))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent))
