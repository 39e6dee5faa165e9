"""The table of systems: its cells, and its rows."""

from __future__ import annotations

import re
import tomllib

import platforms
import pytest
from bundle import own_requirements
from packaging.utils import canonicalize_name
from platforms import PAGE, PYTHONS, ROOT, Answer

GOOD = Answer(frozenset(canonicalize_name(need.name) for need in own_requirements(["gui"])))
WITHOUT = Answer(GOOD.names - {"pyqt5"})
BAD = Answer(frozenset(), "mujoco-core")


@pytest.mark.parametrize(
    ("answers", "text"),
    [
        ((GOOD,) * 4, "yes"),
        ((WITHOUT,) * 4, "yes, without pyqt5"),
        ((BAD,) * 4, "no: mujoco-core"),
        ((GOOD, GOOD, BAD, BAD), "3.11, 3.12; others lack mujoco-core"),
    ],
)
def test_a_cell_says_what_can_be_installed(answers: tuple[Answer, ...], text: str) -> None:
    assert platforms.cell(answers, "gui") == text


def test_the_page_has_a_row_for_each_extra_and_says_what_was_not_run() -> None:
    page = PAGE.read_text(encoding="utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    rows = re.findall(r"^\| ([a-z]+) \|", page.partition("## What can be installed")[2], re.MULTILINE)
    assert set(rows) - {"extra"} == set(project["optional-dependencies"]) - {"all"}
    assert page.count("**not run**") == 2 * (len(platforms.SYSTEMS) - len(platforms.TESTED))
    assert f"Python {PYTHONS[0]} to {PYTHONS[-1]}" in page
