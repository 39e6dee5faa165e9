"""Ask the registry which extra can be installed where, check types for each system, and write docs/reference/platforms.md.

python tools/platforms.py

Needs uv and a network. uv chooses packages for other systems and Pythons without having them; only wheels count, in
the versions of constraints.txt. What was tested and run is known to people only: TESTED.
"""

from __future__ import annotations

import datetime as dt
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from bundle import own_requirements
from packaging.utils import canonicalize_name

ROOT: Final = Path(__file__).resolve().parents[1]
PAGE: Final = ROOT / "docs/reference/platforms.md"
SYSTEMS: Final = {
    "Linux x86-64": ("x86_64-manylinux_2_28", "linux"),
    "Linux ARM64": ("aarch64-manylinux_2_28", "linux"),
    "Windows x86-64": ("x86_64-pc-windows-msvc", "win32"),
    "macOS ARM64": ("aarch64-apple-darwin", "darwin"),
    "macOS x86-64": ("x86_64-apple-darwin", "darwin"),
}
"""uv's name of each system, and Python's."""
PYTHONS: Final = ("3.11", "3.12", "3.13", "3.14")
TESTED: Final = {"Linux x86-64": ("3.11: all tests; 3.12 and 3.13: `tests/unit`", "all programs, with 3.11")}
"""What was tested and run, by system; on all others nothing was."""
NOT_RUN: Final = "**not run**"
BASE: Final = "(none)"
"""The row of BEATRIX without an extra."""
MACOS: Final = "14.0"
"""Oldest macOS: wheels of `av` need it."""
LIMIT_S: Final = 300.0
AT_ONCE: Final = 8
"""Questions at the same time: each mostly waits for the registry."""
CAUSE: Final = re.compile(r"(?:Because|and) ([\w.-]+?)(?:==[\w.]+)? has no (?:usable )?wheels")

HEAD: Final = """# Systems

Written by `make platforms` on {day}, with the versions of `constraints.txt`.

**Only Linux x86-64 was tested and run.** For the others the table says what was checked from there; if you run BEATRIX
on one, please report what happens.

| system | resolved | type-checked | tested | run |
|---|---|---|---|---|
{systems}

- *resolved*: a wheel of every package exists for {pythons}.
  They need glibc 2.28 or newer on Linux, and macOS 14 or newer.
- *type-checked*: `mypy --platform` finds no error in the packages, in the branches that this system takes.
- *tested*: the tests have passed there, with these Pythons.
- *run*: a person has used it there.

`.github/workflows/test.yml` describes tests on Linux, Windows and macOS. It has not run yet.

## What can be installed

By extra of `beatrix install`, or of `pip install ".[EXTRA]"` in the folder of BEATRIX. *yes*: wheels exist for {pythons}.

{extras}

## What to know

- **Windows** has no `make`: type `py tools/setup.py demo`, then `.venv\\Scripts\\beatrix demo`. Use Python 3.13 or newer:
  up to 3.12 its clock ticks only every 16 ms, so motions would be less smooth. `--legacy` is refused, because Windows
  has no pseudo-terminals. Programs of pupils run without a sandbox, as on macOS.
- **Intel Macs** have no MuJoCo 4, no Rerun and no present version of cryptography: they can be seats, with window and
  page, and serve a real robot, but not simulate, record or make the accounts of a class.
- **Linux on ARM**, such as a Raspberry Pi with a 64-bit system: PyQt5 has no wheel there. Install the packages
  `python3-pyqt5` and `python3-pyqt5.qtsvg` of the system, and make the environment with `--system-site-packages`.
"""


@dataclass(frozen=True)
class Answer:
    """What uv says about some extras on one system with one Python."""

    names: frozenset[str]
    """packages, if all have wheels"""
    lacks: str = ""
    """the package without a wheel"""


def ask(uv: str, system: str, python: str, extras: Sequence[str], *, offline: bool = False) -> Answer:
    """Return what uv says about extras, `offline` from what it has read before if that is enough.

    Exits if uv says something else than that a wheel is missing.
    """
    command = [uv, "pip", "compile", "pyproject.toml", "--constraint", "constraints.txt", "--quiet"]
    command += ["--no-header", "--no-annotate", "--only-binary", ":all:", "--python-version", python]
    command += ["--python-platform", SYSTEMS[system][0], *(["--offline"] if offline else [])]
    command += [word for extra in extras for word in ("--extra", extra)]
    environment = os.environ | {"MACOSX_DEPLOYMENT_TARGET": MACOS}
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=LIMIT_S, check=False, env=environment
    )
    if done.returncode == 0:
        lines = [line.partition("==")[0] for line in done.stdout.splitlines()]
        return Answer(frozenset(canonicalize_name(line) for line in lines if line and line[0] != "#"))
    found = CAUSE.search(" ".join(done.stderr.split()))
    if found is not None:
        return Answer(frozenset(), found[1])
    if offline:
        return ask(uv, system, python, extras)
    sys.exit(f"uv cannot resolve {', '.join(extras)} for {system}, Python {python}:\n{done.stderr}")


def cell(answers: Sequence[Answer], extra: str) -> str:
    """Return the text for one extra on one system, from an answer for each of PYTHONS."""
    fits = [python for python, answer in zip(PYTHONS, answers, strict=True) if not answer.lacks]
    lacks = sorted({answer.lacks for answer in answers} - {""})
    if not fits:
        return f"no: {', '.join(lacks)}"
    wanted = {canonicalize_name(need.name) for need in own_requirements(own(extra))}
    names = frozenset.union(*(answer.names for answer in answers))
    left_out = f", without {', '.join(sorted(wanted - names))}" if wanted - names else ""
    if len(fits) == len(PYTHONS):
        return f"yes{left_out}"
    return f"{', '.join(fits)}{left_out}; others lack {', '.join(lacks)}"


def all_cells(uv: str, extras: Sequence[str]) -> dict[str, list[str]]:
    """Return the column of each system; where all extras together have wheels, each has."""
    places = [(system, python) for system in SYSTEMS for python in PYTHONS]
    with ThreadPoolExecutor(AT_ONCE) as pool:
        answers = pool.map(lambda place: ask(uv, place[0], place[1], extras), places)
        together = dict(zip(places, answers, strict=True))
        single = [(place, extra) for place in places if together[place].lacks for extra in (BASE, *extras)]
        answers = pool.map(lambda one: ask(uv, one[0][0], one[0][1], own(one[1]), offline=True), single)
        alone = dict(zip(single, answers, strict=True))

    def column(system: str) -> list[str]:
        places = [(system, python) for python in PYTHONS]
        return [
            cell([alone.get((place, extra), together[place]) for place in places], extra)
            for extra in (BASE, *extras)
        ]

    return {system: column(system) for system in SYSTEMS}


def own(extra: str) -> tuple[str, ...]:
    """Return the extras of a row."""
    return () if extra == BASE else (extra,)


def type_checked(platform: str) -> str:
    """Return what mypy finds in the packages for a platform."""
    words = ["--platform", platform, "--cache-dir", f".mypy_cache/{platform}", "--no-error-summary"]
    packages = [name for name in ("beatrix_zenoh", "sim_node", "hw_node", "gui") if (ROOT / name).is_dir()]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *words, *packages],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    return f"{done.stdout.count(' error: ')} errors" if done.returncode else "yes"


def summary(cells: Sequence[str]) -> str:
    """Return a column in a few words."""
    if all(text == "yes" for text in cells):
        return "all extras"
    return (
        "not all: see below"
        if any(text.startswith("no") for text in cells)
        else "all extras, with gaps: see below"
    )


def row(cells: Sequence[str]) -> str:
    """Return a row of a table."""
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the page, and write it."""
    uv = shutil.which("uv") or sys.exit("This needs uv on PATH: type `pip install uv`, then try again.")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = sorted(name for name in project["optional-dependencies"] if name != "all")
    columns = all_cells(uv, extras)
    types = {
        platform: type_checked(platform) for platform in sorted({names[1] for names in SYSTEMS.values()})
    }
    systems = [
        row((system, summary(cells), types[SYSTEMS[system][1]], *TESTED.get(system, (NOT_RUN, NOT_RUN))))
        for system, cells in columns.items()
    ]
    table = [row(("extra", *SYSTEMS)), "|---" * (len(SYSTEMS) + 1) + "|"]
    table += [row(cells) for cells in zip((BASE, *extras), *columns.values(), strict=True)]
    page = HEAD.format(
        day=dt.datetime.now(dt.UTC).date(),
        pythons=f"Python {PYTHONS[0]} to {PYTHONS[-1]}",
        systems="\n".join(systems),
        extras="\n".join(table),
    )
    print(page)
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
