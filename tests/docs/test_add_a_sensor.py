"""The page about a new sensor: its changes apply, and all programs show the switch without a change of their own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from shutil import copytree, ignore_patterns

import pytest
from robots import ROOT, Stage

PAGE = ROOT / "docs/how-to/add-a-sensor.md"
FILE = re.compile(r"^--- \S+\n\+\+\+ b/(\S+)\n", re.MULTILINE)
HUNK = re.compile(r"@@ .* @@ ?(.*)")
SHOWN = """
import sys
from beatrix_zenoh import Robot
from beatrix_zenoh.cli import app
from gui.console.state.pills import details
from gui.console.texts import Texts
with Robot("bea", "hw", connect=sys.argv[-1]) as robot:
    while not robot.status().pressed:
        pass
    print(details(robot.status(), Texts("en")))
for verb in (["status"], ["status", "--json"], ["echo", "touch", "--count", "1"]):
    app.run([*verb, *sys.argv[1:]])
"""

pytestmark = pytest.mark.no_cover  # a copy of the packages


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


def added(text: str, hunks: str) -> str:
    """Return a text with the lines that a diff adds, each below the line that stands above it in the diff.

    Unlike `git apply` it accepts changes below that line, so that a new field of the status breaks no page.
    """
    lines, at = text.splitlines(), 0
    for hunk in hunks.splitlines():
        kind, line = hunk[:1], hunk[1:]
        if head := HUNK.match(hunk):
            at = next((n + 1 for n, found in enumerate(lines) if head[1] and found.startswith(head[1])), at)
        elif kind == "+":
            lines.insert(at, line)
            at += 1
        elif line in lines[at:]:
            at = lines.index(line, at) + 1 if line else at + (lines[at] == "")
        else:
            assert kind == " ", f"the page removes a line: {hunk}"
    return "\n".join(lines) + "\n"


def run(folder: Path, *words: str) -> str:
    """Run Python with the packages of a folder, and return its output."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    command = [sys.executable, *words]
    done = subprocess.run(
        command, check=False, cwd=folder, env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_switch_in_four_files_is_shown_by_all_programs(stage: Stage, tmp_path: Path) -> None:
    changes = "".join(re.findall(r"^```diff\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL))
    _, *parts = FILE.split(changes)
    assert len(parts) == 2 * 4
    folder = tmp_path / "beatrix"
    for part in ("beatrix_zenoh", "hw_node", "gui", "schemas", "firmware/beatrix", "docs/reference"):
        copytree(ROOT / part, folder / part, ignore=ignore_patterns("__pycache__"))
    (folder / "pyproject.toml").write_bytes((ROOT / "pyproject.toml").read_bytes())
    for name, hunks in zip(parts[::2], parts[1::2], strict=True):
        path = folder / name
        path.write_text(added(path.read_text() if path.exists() else "", hunks))
    run(folder, "schemas/generate.py")

    switch = tmp_path / "value"
    switch.write_text("1\n")
    where = ("--name", "bea", "--connect", stage.endpoint)
    hardware = ("-m", "beatrix_zenoh.cli", "hw", "--port", "virtual:", "--touch", str(switch))
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    with subprocess.Popen(
        [sys.executable, *hardware, *where], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True
    ) as node:
        try:
            assert node.stdout is not None
            assert "ready" in node.stdout.readline()
            shown = run(folder, "-c", SHOWN, *where)
            assert "touch: pressed\n" in shown
            assert re.search(r"^touch +pressed +yes$", shown, re.MULTILINE)
            assert re.search(r'"pressed": ?true', shown)
            assert re.search(r"^bea \(hw\)  seq .*, pressed yes$", shown, re.MULTILINE)
        finally:
            node.terminate()
