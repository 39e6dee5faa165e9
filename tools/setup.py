"""Make .venv, and install the Debian packages that it or the tests need: `python tools/setup.py demo`, `test`, `site`.

A stamp file in .venv records the inputs of .venv, so that nothing is done twice. This program needs only Python 3.11.
"""

from __future__ import annotations

import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
CONSTRAINTS = ROOT / "constraints.txt"
TEST = "cli,hw,sim,plot,rerun,analyse,mcap,gym,gui,classroom,web"
EXTRAS = {"demo": "cli,hw,sim,rerun,web", "test": TEST, "site": TEST}
"""By purpose; a .venv of one serves those before it. The demo takes what its first minute needs; `beatrix install` adds
the rest when it is wanted."""
GROUPS = {"demo": [], "test": ["dev"], "site": ["dev", "site"]}


def run(command: Sequence[str]) -> bool:
    """Print the command and run it; return whether it succeeded."""
    print("+", shlex.join(command), flush=True)
    return subprocess.run(command, cwd=ROOT, check=False).returncode == 0


def works(command: Sequence[str]) -> bool:
    """Return whether the command exists on this computer and succeeds."""
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def wanted_packages(purpose: str) -> list[str]:
    """Return the Debian packages listed for this purpose."""
    text = (ROOT / "tools/debian-packages.txt").read_text(encoding="utf-8")
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    return [row[1] for row in rows if row[0] == purpose]


def missing_packages(purpose: str) -> list[str]:
    """Return the Debian packages of this purpose that are not installed."""
    wanted = wanted_packages(purpose)
    query = ["dpkg-query", "--show", "--showformat", "${db:Status-Status} ${Package}\n", *wanted]
    shown = subprocess.run(query, capture_output=True, text=True, check=False).stdout
    installed = {line.split()[1] for line in shown.splitlines() if line.startswith("installed ")}
    return [name for name in wanted if name not in installed]


def install_debian_packages(purpose: str) -> None:
    """Install the missing Debian packages, or exit with a message if that fails; on other systems print their names."""
    if not shutil.which("dpkg-query"):
        print(
            f"This system is not Debian. Install the equivalents of these packages yourself: {', '.join(wanted_packages(purpose))}."
        )
        return
    missing = missing_packages(purpose)
    if not missing:
        return
    install = ["apt-get", "install", "--yes", "--no-install-recommends", *missing]
    if os.geteuid() == 0:
        become_root = ["env", "DEBIAN_FRONTEND=noninteractive"]
    elif works(["sudo", "-n", "true"]):
        become_root = ["sudo", "-n", "env", "DEBIAN_FRONTEND=noninteractive"]
    else:
        sys.exit(
            f"Debian packages are missing. Type this command, then try again:\n\n    sudo {shlex.join(install)}\n"
        )
    run([*become_root, "apt-get", "update"])
    if not run([*become_root, *install]):
        sys.exit("apt-get cannot install the Debian packages. See its output above.")


def python() -> str:
    """Return implementation, version and path of this interpreter, from which .venv is made."""
    return f"{sys.implementation.name} {sys.version.split()[0]} {Path(sys.executable).resolve()}"


def digest() -> str:
    """Return a digest of all inputs of .venv."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    parts = [
        EXTRAS,
        project["project"],
        project["build-system"],
        project["dependency-groups"],
        sys.version_info[:2],
    ]
    text = json.dumps(parts) + CONSTRAINTS.read_text(encoding="utf-8")
    return hashlib.sha256(text.encode()).hexdigest()


def requirements(purpose: str) -> list[str]:
    """Return the arguments of pip: the constraints, the project, and the groups of this purpose."""
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["dependency-groups"]
    packages = [package for group in GROUPS[purpose] for package in groups[group]]
    return ["--constraint", str(CONSTRAINTS), "--editable", f".[{EXTRAS[purpose]}]", *packages]


def empty_venv() -> None:
    """Make .venv, with uv if this computer has it; exit with a message if that fails."""
    if works(["uv", "--version"]) and run(
        ["uv", "venv", "--seed", "--clear", "--python", sys.executable, str(VENV)]
    ):
        return
    if not works([sys.executable, "-c", "import ensurepip"]):
        install_debian_packages("venv")
    if not run([sys.executable, "-m", "venv", "--clear", str(VENV)]):
        sys.exit("Python cannot make .venv. See its output above.")


def installers() -> Iterator[list[str]]:
    """Yield the commands that install packages, the fastest first; uv is put into .venv if there is none."""
    into = ["pip", "install", "--python", str(PYTHON)]
    pip = [str(PYTHON), "-m", "pip", "install"]
    if works(["uv", "--version"]):
        yield ["uv", *into]
    elif works([str(PYTHON), "-m", "uv", "--version"]) or run([*pip, "--quiet", "uv"]):
        yield [str(PYTHON), "-m", "uv", *into]
    if works([*pip, "--help"]):
        yield pip


def make_venv(purpose: str) -> None:
    """Make .venv unless it exists with the same inputs, for this purpose or a later one of EXTRAS."""
    stamp = VENV / "made-from.json"
    made = json.loads(stamp.read_text(encoding="utf-8")) if stamp.exists() else {}
    purposes = list(EXTRAS)
    if made.get("digest") == digest() and purposes.index(purpose) <= purposes.index(made["purpose"]):
        return
    # An existing .venv of this Python is updated, not replaced: running robots may use it.
    fresh = made.get("python") != python()
    stamp.unlink(missing_ok=True)
    if fresh:
        empty_venv()
    if not any(run([*command, *requirements(purpose)]) for command in installers()):
        sys.exit("The packages of BEATRIX cannot be installed. See the output above; is there a network?")
    stamp.write_text(
        json.dumps({"digest": digest(), "purpose": purpose, "python": python()}), encoding="utf-8"
    )


def main() -> int:
    """Set up this checkout for one purpose."""
    if len(sys.argv) != 2 or sys.argv[1] not in EXTRAS:
        sys.exit(f"usage: python tools/setup.py {'|'.join(EXTRAS)}")
    purpose = sys.argv[1]
    if purpose == "test":
        install_debian_packages(purpose)
    make_venv(purpose)
    return 0


if __name__ == "__main__":
    sys.exit(main())
