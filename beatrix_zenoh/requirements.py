"""The packages that BEATRIX needs, and those in a folder that it cannot use: of another version, or for another Python."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

DISTRIBUTION = "beatrix-zenoh"
THIS = f"{sys.version_info[0]}.{sys.version_info[1]}"
NAME = re.compile(r"([A-Za-z0-9._-]+)")
INFO = re.compile(r"(?P<name>[^-]+)-(?P<version>[^-]+)(-.*)?\.(dist|egg)-info")
"""Name of a folder or file that describes an installed distribution."""
BOUND = re.compile(r"(>=|<)\s*([\d.]+)")


def requirements() -> list[str]:
    """Return the requirements of this package and of its extras; none if it is not installed."""
    try:
        return metadata.requires(DISTRIBUTION) or []
    except metadata.PackageNotFoundError:
        return []


def distribution(requirement: str) -> str:
    """Return the name of the distribution in a requirement, in the form in which names are compared."""
    name = NAME.match(requirement)
    return re.sub("[-_.]+", "-", name[1]).lower() if name else ""


def bounds(requirement: str) -> str:
    """Return a requirement without its markers (`numpy>=2.0`)."""
    return requirement.partition(";")[0].strip()


def suits(version: str, requirement: str) -> bool:
    """Return whether a version is inside the bounds of a requirement."""

    def numbers(text: str) -> list[int]:
        return [int(number) for number in re.findall(r"\d+", text)[:3]]

    found = BOUND.findall(bounds(requirement))
    return all((numbers(version) < numbers(bound)) == (sign == "<") for sign, bound in found)


def misfits(folders: Iterable[str], *, core: bool = False) -> dict[str, tuple[str, str]]:
    """Return the packages in these folders that BEATRIX cannot use, each with what is wrong and what to do.

    `core`: only those that every program of BEATRIX needs. Of two versions Python imports that of the first folder.
    """
    needed = {distribution(line): line for line in requirements() if not (core and "extra ==" in line)}
    found: dict[str, tuple[str, str] | None] = {}
    for folder in map(Path, folders):
        for info in map(INFO.fullmatch, sorted(path.name for path in folder.glob("*-info"))):
            name = distribution(info["name"]) if info else ""
            if info is None or name in found or name not in needed:
                continue
            made_for = other_python(folder / info[0] / "WHEEL")
            what = f"{folder.resolve()} contains {name} {info['version']}"
            do = f"take {folder.resolve()} out of PYTHONPATH, or {name} out of this folder"
            if made_for:
                found[name] = (f"{what} for Python {made_for}, and this is Python {THIS}", do)
            elif not suits(info["version"], needed[name]):
                found[name] = (f"{what}, and BEATRIX needs {bounds(needed[name])}", do)
            else:
                found[name] = None
    return {name: texts for name, texts in found.items() if texts is not None}


def other_python(wheel: Path) -> str:
    """Return for which Python the package of this file was made; empty: for this one, or it is not known."""
    try:
        tags = re.findall(r"^Tag: cp(\d)(\d*)-(\w+)-", wheel.read_text("utf-8", "replace"), re.MULTILINE)
    except OSError:
        return ""
    mine = ("none", "abi3", f"cp{THIS.replace('.', '')}")
    return "" if not tags or any(abi.startswith(mine) for *_, abi in tags) else ".".join(tags[0][:2])
