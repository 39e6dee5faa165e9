"""Pack BEATRIX with all packages that it needs into one archive, for a USB stick and a room without network.

python tools/bundle.py [--platform windows-x86_64] [--python 3.12] [--extras cli,gui] [--out FOLDER]

The archive contains the wheels of the versions in constraints.txt, the program install.py, which needs only Python,
a README.txt, and the robot as MJCF and URDF. The firmware of the board is inside the wheel of BEATRIX.
"""

from __future__ import annotations

import argparse
import platform
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Final

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from sim_node.robot_files import write as write_robot

ROOT: Final = Path(__file__).resolve().parents[1]
PROJECT: Final = "beatrix-zenoh"
PLATFORMS: Final = {
    "linux-x86_64": (
        "linux",
        "x86_64",
        [f"manylinux_2_{minor}_x86_64" for minor in (17, 24, 27, 28, 31, 34)],
    ),
    "linux-aarch64": (
        "linux",
        "aarch64",
        [f"manylinux_2_{minor}_aarch64" for minor in (17, 24, 27, 28, 31, 34)],
    ),
    "windows-x86_64": ("win32", "AMD64", ["win_amd64"]),
    "macos-arm64": (
        "darwin",
        "arm64",
        [f"macosx_{major}_0_{cpu}" for major in range(11, 16) for cpu in ("arm64", "universal2")],
    ),
}
"""`sys.platform`, `platform.machine()` and the tags of suitable wheels, by platform."""
SYSTEMS: Final = {"linux": "Linux", "win32": "Windows", "darwin": "Darwin"}

INSTALL: Final = '''"""Install BEATRIX from this folder, without network: python install.py [FOLDER]"""
import os, subprocess, sys, venv
from pathlib import Path

here = Path(__file__).resolve().parent
home = Path(sys.argv[1] if len(sys.argv) > 1 else "beatrix-env").resolve()
if sys.version_info[:2] != {python}:
    sys.exit("These wheels do not fit Python %d.%d. Use Python {python_text}." % sys.version_info[:2])
venv.create(home, with_pip=True)
scripts = home / ("Scripts" if os.name == "nt" else "bin")
subprocess.run(
    [scripts / "python", "-m", "pip", "install", "--no-index", "--find-links", here / "wheels", "{what}"], check=True
)
print("Installed. Type:", scripts / "beatrix", "--help")
'''
READ_ME: Final = """BEATRIX {version} for {platform}, Python {python_text}.

Unpack this archive and type in its folder:

    python install.py

install.py needs Python {python_text} and no network. It makes the folder beatrix-env.
The program `beatrix` is in beatrix-env/bin, on Windows in beatrix-env/Scripts.
The folder robot has the robot as MJCF (MuJoCo) and URDF (ROS, Rerun), for other programs.
"""


def environment(target: str, python: str) -> dict[str, str]:
    """Return the values of environment markers on a platform (PEP 508)."""
    system, machine, _ = PLATFORMS[target]
    return {
        "implementation_name": "cpython",
        "implementation_version": f"{python}.0",
        "os_name": "nt" if system == "win32" else "posix",
        "platform_machine": machine,
        "platform_python_implementation": "CPython",
        "platform_release": "",
        "platform_system": SYSTEMS[system],
        "platform_version": "",
        "python_full_version": f"{python}.0",
        "python_version": python,
        "sys_platform": system,
    }


def applies(requirement: Requirement, values: dict[str, str], extras: Sequence[str] = ("",)) -> bool:
    """Return whether a requirement is needed on a platform with any of the extras."""
    marker = requirement.marker
    return marker is None or any(marker.evaluate({**values, "extra": extra}) for extra in extras)


def own_requirements(extras: Sequence[str]) -> Iterator[Requirement]:
    """Yield the requirements in pyproject.toml for these extras; extras that name BEATRIX are expanded."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    texts = [
        *project["dependencies"],
        *(text for extra in extras for text in project["optional-dependencies"][extra]),
    ]
    for requirement in map(Requirement, texts):
        if requirement.name == PROJECT:
            yield from own_requirements(sorted(requirement.extras))
        else:
            yield requirement


@cache
def needs_of(name: str) -> list[Requirement]:
    """Return what an installed package needs; nothing if it is not installed here, so needed only on other platforms."""
    try:
        return [Requirement(need) for need in metadata.requires(name) or []]
    except metadata.PackageNotFoundError:
        return []


def names_of(requirements: Sequence[Requirement], values: dict[str, str]) -> set[str]:
    """Return the names of all required packages on a platform, from the metadata of the packages installed here."""
    seen: set[tuple[str, frozenset[str]]] = set()
    waiting = [requirement for requirement in requirements if applies(requirement, values)]
    while waiting:
        requirement = waiting.pop()
        found = canonicalize_name(requirement.name), frozenset(requirement.extras)
        if found in seen:
            continue
        seen.add(found)
        extras = ["", *requirement.extras]
        waiting += [need for need in needs_of(requirement.name) if applies(need, values, extras)]
    return {name for name, _ in seen}


def pins(values: dict[str, str]) -> dict[str, str]:
    """Return the version of each package of constraints.txt that applies to a platform."""
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    found = [Requirement(line) for line in lines if re.match(r"[A-Za-z0-9]", line)]
    return {
        canonicalize_name(pin.name): str(pin.specifier).removeprefix("==")
        for pin in found
        if applies(pin, values)
    }


def download(target: str, python: str, extras: Sequence[str], wheels: Path) -> None:
    """Put the wheel of this checkout and those of all packages that it needs into a folder."""
    values = environment(target, python)
    versions, names = pins(values), names_of(list(own_requirements(extras)), values)
    tags = [argument for tag in PLATFORMS[target][2] for argument in ("--platform", tag)]
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    own = [*pip, "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(wheels), str(ROOT)]
    subprocess.run(own, check=True)
    others = [*pip, "download", "--no-deps", "--only-binary=:all:", "--dest", str(wheels)]
    pinned = [f"{name}=={versions[name]}" for name in sorted(names)]
    subprocess.run([*others, "--python-version", python, *tags, *pinned], check=True)


def bundle(target: str, python: str, extras: Sequence[str], out: Path) -> Path:
    """Write the archive, and return its path."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    folder = out / f"beatrix-{version}-{target}-python{python}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    download(target, python, extras, folder / "wheels")
    (folder / "robot").mkdir()
    for form in (".xml", ".urdf"):
        write_robot(folder / f"robot/beatrix{form}")
    words = {"python_text": python, "version": version, "platform": target}
    number = tuple(map(int, python.split(".")))
    what = f"{PROJECT}[{','.join(extras)}]"
    (folder / "install.py").write_text(INSTALL.format(python=number, what=what, **words), encoding="utf-8")
    (folder / "README.txt").write_text(READ_ME.format(**words), encoding="utf-8")
    return Path(shutil.make_archive(str(folder), "zip", out, folder.name))


def here() -> str:
    """Return the name of this computer's platform; linux-x86_64 if PLATFORMS does not contain it."""
    for name, (system, machine, _) in PLATFORMS.items():
        if (sys.platform, platform.machine()) == (system, machine):
            return name
    return "linux-x86_64"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--platform", choices=PLATFORMS, default=here())
    parser.add_argument("--python", default=f"{sys.version_info.major}.{sys.version_info.minor}")
    parser.add_argument(
        "--extras",
        default="all",
        help="extras of pyproject.toml, separated by commas; a seat needs cli or cli,gui",
    )
    parser.add_argument("--out", type=Path, default=ROOT / "build/bundle")
    options = parser.parse_args()
    archive = bundle(options.platform, options.python, options.extras.split(","), options.out)
    print(f"{archive}: {archive.stat().st_size / 1e6:.0f} MB")


if __name__ == "__main__":
    main()
