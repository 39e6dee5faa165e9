"""Mutation testing within a time limit: change one expression or statement at a time; check whether a test fails.

    .venv/bin/python tools/mutate.py --minutes 10 --sample 60 beatrix_zenoh/node/planner.py

Without paths it mutates the packages of the node and of the client. The project is copied to a temporary folder; only
the copy is changed. A first run of the unit tests, and of the contract tests on the body `in-process`, records which
test executes which line. Each mutant is then tested by the tests that execute its line, and survives if all of them
pass:

    beatrix_zenoh/node/planner.py:107  roll + here[2] -> roll - here[2]

A survivor does not always show a defect of the tests: some mutants are equivalent to the original. Runs with the same
--seed select the same mutants in the same order.
"""

from __future__ import annotations

import argparse
import ast
import builtins
import contextlib
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from pathlib import Path

from coverage import CoverageData

ROOT = Path(__file__).resolve().parent.parent
TARGETS = ("beatrix_zenoh/node", "beatrix_zenoh/client")
SUITES = (("tests/unit", ""), ("tests/contract", "in-process and not flood"))
"""Folders of tests, and the `-k` expression that selects from each."""
LEFT_OUT = (
    "tests/unit/test_project_rules.py",
    "tests/unit/test_mutate.py",
    "tests/unit/test_shutdown.py",  # a signal between two tests deadlocks on a lock of coverage
)
NOT_COPIED = (".git", ".venv", "__pycache__", ".mypy_cache", ".ruff_cache", "build", "demo-out")
VERDICTS = ("killed", "survived", "undecided", "not run")
MUTANT_S = 100.0
"""Time limit (s) of the tests of a mutant; a mutant whose tests take longer counts as `undecided`."""

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.Gt: ast.GtE, ast.Eq: ast.NotEq, ast.Is: ast.IsNot, ast.In: ast.NotIn,
    ast.LtE: ast.Lt, ast.GtE: ast.Gt, ast.NotEq: ast.Eq, ast.IsNot: ast.Is, ast.NotIn: ast.In,
}  # fmt: skip
ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
}  # fmt: skip
SHOWN = 90
"""Largest number of characters printed of the original and of the mutated code."""


Located = ast.expr | ast.stmt | ast.keyword
"""A node with a position in the source."""


@dataclass(frozen=True)
class Mutant:
    """One change of one file: the bytes from `start` to `end` become `mutated`."""

    line: int
    start: int
    end: int
    original: str
    mutated: str

    def apply(self, source: str) -> str:
        """Return the source with the change."""
        data = source.encode()
        return (data[: self.start] + self.mutated.encode() + data[self.end :]).decode()

    def __str__(self) -> str:
        return " -> ".join(
            textwrap.shorten(text, SHOWN, placeholder=" …") for text in (self.original, self.mutated)
        )


def mutants(source: str) -> list[Mutant]:
    """Return all mutants of a module, in the order of their positions."""
    data = source.encode()
    starts = [0, *accumulate(len(line) for line in data.splitlines(keepends=True))]
    found: dict[tuple[int, str, str], Mutant] = {}  # only the first of equal mutants on a line
    for node in _mutable(ast.parse(source)):
        for first, last, mutated in _changes(node):
            start = starts[first.lineno - 1] + first.col_offset
            end = starts[(last.end_lineno or last.lineno) - 1] + (last.end_col_offset or 0)
            original = data[start:end].decode()
            mutant = Mutant(first.lineno, start, end, original, mutated)
            found.setdefault((mutant.line, original, mutated), mutant)
    return sorted(found.values(), key=lambda mutant: mutant.start)


def _mutable(node: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    """Yield the expressions and statements that are worth mutating: no annotations, decorators or messages."""
    if isinstance(node, ast.JoinedStr | ast.Import | ast.ImportFrom | ast.Assert):
        return
    if isinstance(node, ast.expr | ast.stmt):
        yield node
    if isinstance(node, ast.Raise):
        return
    for name, value in ast.iter_fields(node):
        if name not in ("annotation", "returns", "decorator_list"):
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from _mutable(child)


def _changes(node: ast.expr | ast.stmt) -> Iterator[tuple[Located, Located, str]]:
    """Yield for each mutant of a node the first and the last node that are replaced, and the replacement."""
    if isinstance(node, ast.Call):
        yield from _swapped(node)
    mutated = _statement(node) if isinstance(node, ast.stmt) else _expression(node)
    if mutated:
        yield node, node, mutated


def _statement(node: ast.stmt) -> str:
    """Return the replacement of a statement; empty if there is none."""
    match node:
        case ast.Return(value=ast.expr() as value) if ast.unparse(value) != "None":
            return "return None"
        case (
            ast.Expr(value=ast.Call()) | ast.Raise() | ast.AugAssign() | ast.Assign(targets=[ast.Attribute()])
        ):
            return "pass"
    return ""


def _expression(node: ast.expr) -> str:
    """Return the replacement of an expression; empty if there is none."""
    text = ""
    match node:
        case ast.Compare(ops=[comparison]):
            text = ast.unparse(ast.Compare(node.left, [COMPARISONS[type(comparison)]()], node.comparators))
        case ast.BoolOp(op=junction):
            other = ast.Or() if isinstance(junction, ast.And) else ast.And()
            text = f"({ast.unparse(ast.BoolOp(other, node.values))})"
        case ast.UnaryOp(op=ast.Not()):
            text = f"({ast.unparse(node.operand)})"
        case ast.BinOp(op=operator) if type(operator) in ARITHMETIC and not _text(node):
            text = f"({ast.unparse(ast.BinOp(node.left, ARITHMETIC[type(operator)](), node.right))})"
        case ast.Constant(value=bool(value)):
            text = str(not value)
        case ast.Constant(value=int(number)):
            text = str(number - 1 if number == 2 else number + 1)  # 2 is often the last of three indices
        case ast.Constant(value=float(number)):
            text = str(number * 2 / 3 if number else 1.0)
    return text


def _text(node: ast.BinOp) -> bool:
    """Return whether the node contains a string literal, and so probably concatenates strings."""
    return any(
        isinstance(part, ast.JoinedStr) or (isinstance(part, ast.Constant) and isinstance(part.value, str))
        for part in ast.walk(node)
    )


def _swapped(call: ast.Call) -> Iterator[tuple[Located, Located, str]]:
    """Yield the exchanges of two neighbouring arguments that have the same form and different names."""
    if isinstance(call.func, ast.Name) and hasattr(builtins, call.func.id):
        return
    for first, second in pairwise(call.args):
        if _alike(first, second):
            yield first, second, f"{ast.unparse(second)}, {ast.unparse(first)}"
    for one, other in pairwise(call.keywords):
        if _alike(one.value, other.value):
            yield one, other, f"{one.arg}={ast.unparse(other.value)}, {other.arg}={ast.unparse(one.value)}"


def _alike(first: ast.expr, second: ast.expr) -> bool:
    """Return whether two expressions contain names and differ only in them."""
    one, other = ast.dump(first), ast.dump(second)
    names = re.compile(r"(id|attr)='\w*'")
    return one != other and "id=" in one and names.sub("", one) == names.sub("", other)


class Copy:
    """A copy of the project in a temporary folder, and the lines that its tests execute."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.root = folder / "project"
        shutil.copytree(root, self.root, ignore=shutil.ignore_patterns(*NOT_COPIED), symlinks=True)
        self._contexts = folder / "contexts"
        self._broken: set[str] = set()
        self._seconds: dict[str, list[float]] = defaultdict(list)

    def record(self, sources: Sequence[str]) -> set[str]:
        """Run all tests once and record which test executes which line; return the tests that fail without a mutant."""
        for suite, chosen in SUITES:
            if (self.root / suite).is_dir():
                words = [f"--cov={source}" for source in sources] + [f"--ignore={path}" for path in LEFT_OUT]
                command = [
                    suite,
                    "-k",
                    chosen,
                    "--cov-context=test",
                    "--cov-append",
                    "--cov-report=",
                    *words,
                    "--durations=0",
                ]
                _, output = self._pytest(command, timeout_s=1800.0)
                if not re.search(r"\d+ (passed|failed).* in [\d.]+s", output):
                    sys.exit(f"The tests in {suite} did not run to their end:\n{output[-2000:]}")
                for seconds, file in re.findall(r"^([\d.]+)s \w+ +([^:\s]+)::", output, re.MULTILINE):
                    self._seconds[file].append(float(seconds))
                self._broken |= set(re.findall(r"^(?:FAILED|ERROR) (\S+)", output, re.MULTILINE))
        return self._broken

    def tests(self, path: str, line: int) -> list[str]:
        """Return the tests that execute a line.

        For a line that is executed on import, or only on threads that coverage does not trace (Zenoh's callbacks),
        these are the tests that execute any line of its module. For a line that a fixture executes, they include all
        tests of the file that execute the module, because a fixture may serve a whole file.
        """
        data = CoverageData(str(self._contexts))
        data.read()
        contexts = data.contexts_by_lineno(str(self.root / path))
        known = {name.rpartition("|")[0] for names in contexts.values() for name in names if name}
        here = contexts.get(line, [])
        prepared = tuple(name.partition("::")[0] for name in here if name.endswith("|setup"))
        if "" in here or not here:
            found = known
        else:
            found = {name.rpartition("|")[0] for name in here}
            found |= {name for name in known if name.startswith(prepared)}
        return sorted(found - self._broken, key=self._order)

    def _order(self, test: str) -> tuple[float, str]:
        """Return a sort key: fast files first, and the tests of a file together, because they may share a fixture."""
        seconds = self._seconds.get(test.partition("::")[0], [0.0])
        return sum(seconds) / len(seconds), test

    def verdict(self, path: str, mutant: Mutant, seconds: float) -> str:
        """Test a mutant for at most `seconds`; return one of VERDICTS, `not run` if no test executes its module."""
        tests = self.tests(path, mutant.line)
        if not tests:
            return "not run"
        file = self.root / path
        source = file.read_text(encoding="utf-8")
        file.write_text(mutant.apply(source), encoding="utf-8")
        try:
            code, _ = self._pytest(["-x", "--no-cov", *tests], timeout_s=seconds)
        finally:
            file.write_text(source, encoding="utf-8")
        return "undecided" if code is None else "survived" if code == 0 else "killed"

    def _pytest(self, words: Sequence[str], timeout_s: float) -> tuple[int | None, str]:
        """Run tests that import the copy; return the exit code (None after the time limit) and the output."""
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *words]
        environment = dict(os.environ, COVERAGE_FILE=str(self._contexts), PYTHONPATH=str(self.root))
        environment.pop("COVERAGE_PROCESS_CONFIG", None)  # set if coverage measures this program
        # Otherwise Python would reuse bytecode for a source of the same size and second.
        environment["PYTHONDONTWRITEBYTECODE"] = "1"
        with subprocess.Popen(
            command,
            cwd=self.root,
            env=environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as run:
            try:
                output, _ = run.communicate(timeout=timeout_s)
            except subprocess.TimeoutExpired:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(run.pid, signal.SIGKILL)
                return None, ""
        return run.returncode, output


def main(words: Sequence[str] | None = None, root: Path = ROOT) -> int:
    """Print all mutants that were not killed, and the numbers of mutants made, tested, and with each verdict."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("paths", nargs="*", help=f"folders or files; default: {', '.join(TARGETS)}")
    parser.add_argument("--minutes", type=float, default=10.0, help="time for all mutants")
    parser.add_argument("--sample", type=int, help="largest number of mutants, chosen at random")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random choice and order")
    given = parser.parse_args(words)
    deadline = time.monotonic() + 60 * given.minutes
    places = [root / path for path in given.paths or TARGETS if given.paths or (root / path).exists()]
    files = sorted(
        {file for place in places for file in ([place] if place.is_file() else place.rglob("*.py"))}
    )
    paths = [file.relative_to(root).as_posix() for file in files]
    made = [(path, mutant) for path in paths for mutant in mutants((root / path).read_text(encoding="utf-8"))]
    random.Random(given.seed).shuffle(made)
    chosen = made[: given.sample]
    verdicts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        project = Copy(root, Path(folder).resolve())
        for broken in sorted(project.record(sorted({path.split("/")[0] for path in paths}))):
            print(f"skipped, because it fails without a mutant: {broken}")
        for path, mutant in chosen:
            if (left_s := deadline - time.monotonic()) <= 0:
                break
            verdict = project.verdict(path, mutant, min(MUTANT_S, left_s))
            if verdict == "undecided" and time.monotonic() > deadline:
                break
            verdicts[verdict] += 1
            if verdict != "killed":
                remark = "" if verdict == "survived" else f"  ({verdict})"
                print(f"{path}:{mutant.line}  {mutant}{remark}", flush=True)
    counted = ", ".join(f"{verdicts[verdict]} {verdict}" for verdict in VERDICTS)
    print(f"{verdicts.total()} of {len(made)} mutants tested: {counted}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
