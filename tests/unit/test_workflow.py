"""The workflow for GitHub, which has not run yet: it can be read, and starts only what exists."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Final

import yaml

ROOT: Final = Path(__file__).resolve().parents[2]
FILE: Final = ROOT / ".github/workflows/test.yml"
PINNED: Final = re.compile(r"[\w-]+/[\w-]+@v\d+")


def steps() -> list[dict[str, object]]:
    """Return the steps of all jobs."""
    jobs = yaml.safe_load(FILE.read_text(encoding="utf-8"))["jobs"]
    return [step for job in jobs.values() for step in job["steps"]]


def test_the_workflow_starts_only_what_exists() -> None:
    commands = [str(step["run"]) for step in steps() if "run" in step]
    targets = {name for command in commands for name in re.findall(r"\bmake ([a-z-]+)", command)}
    paths = {path for command in commands for path in re.findall(r"\b(?:tools|tests)/[\w/.]+", command)}
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert targets
    assert [name for name in targets if not re.search(rf"^{name}:", makefile, re.MULTILINE)] == []
    assert paths
    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_the_actions_of_the_workflow_have_a_major_version() -> None:
    actions = [str(step["uses"]) for step in steps() if "uses" in step]
    assert actions
    assert [name for name in actions if not PINNED.fullmatch(name)] == []


def test_the_workflow_tests_each_python_that_the_page_names() -> None:
    jobs = yaml.safe_load(FILE.read_text(encoding="utf-8"))["jobs"]
    page = (ROOT / "docs/reference/platforms.md").read_text(encoding="utf-8")
    oldest = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "requires-python"
    ]
    for job in jobs.values():
        pythons = job["strategy"]["matrix"]["python"]
        assert f"Python {pythons[0]} to {pythons[-1]}" in page
        assert oldest == f">={pythons[0]}"
