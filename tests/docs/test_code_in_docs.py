"""The Python of README, tutorial and how-to pages runs as printed, with the files that the page shows."""

from __future__ import annotations

import re
import subprocess
import sys
from code import InteractiveConsole
from collections.abc import Iterator
from pathlib import Path

import pytest
from robots import Stage, wait_status

from beatrix_zenoh import Robot, Twin

ROOT = Path(__file__).resolve().parents[2]
PAGES = (
    "README.md",
    "docs/tutorial/first-steps.md",
    "docs/tutorial/first-steps.de.md",
    "docs/how-to/choreographies.md",
    "docs/how-to/simulated-eyes.md",
    "docs/how-to/microphones.md",
    "docs/how-to/motion-files.md",
    "docs/how-to/cameras.md",
    "docs/how-to/share-a-robot.md",
    "docs/how-to/processes.md",
    "docs/how-to/notebooks.md",
    "docs/how-to/follow.md",
    "beatrix_zenoh/lessons/library/04-look-there/lesson.md",
    "beatrix_zenoh/lessons/library/04-look-there/lesson.de.md",
)
ALWAYS = PAGES[:1]
MOVES = pytest.mark.long("the programs of a page move robots in real time")
FILES = re.compile(r"```(?:csv|toml)\n(# (\S+\.(?:csv|toml))\n.*?)```", re.DOTALL)
"""Files that a page shows; the first line of each is its name."""
PROGRAM = re.compile(r"# (\S+\.py)\n")
"""The first line of Python that is a program of its own, and not typed at the prompt."""


class Prompt(InteractiveConsole):
    """Python's interactive prompt, which accepts code line by line."""

    errors = ""

    def write(self, data: str) -> None:
        self.errors += data


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    """The processes that `beatrix up --name bea1 --hw virtual:` starts, for all pages."""
    with Stage() as made:
        made.simulation("bea1")
        made.hardware("bea1")
        yield made


@pytest.fixture
def robots(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Both robots, as a reader of a page has them: no seat holds them, the motors are off."""
    monkeypatch.setenv("BEATRIX_CONNECT", stage.endpoint)
    monkeypatch.setenv("BEATRIX_ROBOT", "bea1")  # pages of lessons write `Robot()`
    yield
    for side in ("sim", "hw"):
        with Robot("bea1", side) as robot:
            wait_status(
                robot, lambda status: status.holder in ("", robot.client.settings.who), "no other seat"
            )
            robot.stop()
            robot.disable()


@pytest.mark.parametrize(
    "page", [*ALWAYS, *(pytest.param(page, marks=MOVES) for page in PAGES if page not in ALWAYS)]
)
@pytest.mark.timeout(120)
def test_the_python_of_a_page_runs(
    page: str, robots: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert blocks
    monkeypatch.chdir(tmp_path)
    for content, name in FILES.findall(text):
        (tmp_path / name).write_text(content, encoding="utf-8")
    prompt = Prompt({"__name__": "page"})
    for block in blocks:
        if program := PROGRAM.match(block):
            (tmp_path / program[1]).write_text(block, encoding="utf-8")
            subprocess.run([sys.executable, program[1]], check=True, timeout=60)
            continue
        for line in [*block.splitlines(), ""]:
            prompt.push(line)
    for value in prompt.locals.values():
        if isinstance(value, Robot | Twin):  # the router serves the next file, which must not see these seats
            value.close()
    assert prompt.errors == ""
