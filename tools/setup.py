"""Make .venv and see to the Debian packages: `python tools/setup.py demo` or `test`.

Nothing is done twice: a stamp in .venv names what it was made from. Needs only Python 3.11.
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
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
CONSTRAINTS = ROOT / "constraints.txt"
EXTRAS = "cli,hw,sim,plot"
PURPOSES = ("demo", "test")


def run(command: Sequence[str]) -> bool:
    """Show the command and run it; say whether it succeeded."""
    print("+", shlex.join(command), flush=True)
    return subprocess.run(command, cwd=ROOT, check=False).returncode == 0


def works(command: Sequence[str]) -> bool:
    """Say whether the command can be run here at all."""
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def wanted_packages(purpose: str) -> list[str]:
    """Debian packages listed for this purpose."""
    text = (ROOT / "tools/debian-packages.txt").read_text(encoding="utf-8")
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    return [row[1] for row in rows if row[0] == purpose]


def missing_packages(purpose: str) -> list[str]:
    """Debian packages of this purpose that are not installed."""
    wanted = wanted_packages(purpose)
    query = ["dpkg-query", "--show", "--showformat", "${db:Status-Status} ${Package}\n", *wanted]
    shown = subprocess.run(query, capture_output=True, text=True, check=False).stdout
    installed = {line.split()[1] for line in shown.splitlines() if line.startswith("installed ")}
    return [name for name in wanted if name not in installed]


def see_to_debian_packages(purpose: str) -> None:
    """Install the packages that are missing, or say what to type and stop."""
    if not shutil.which("dpkg-query"):
        print(f"This is not Debian: see to what Debian calls {', '.join(wanted_packages(purpose))} yourself.")
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
            f"Debian packages are missing. Type this, then try again:\n\n    sudo {shlex.join(install)}\n"
        )
    run([*become_root, "apt-get", "update"])
    if not run([*become_root, *install]):
        sys.exit("Debian packages could not be installed; apt-get says why above.")


def python() -> str:
    """The Python .venv is made with."""
    return f"{sys.implementation.name} {sys.version.split()[0]} {Path(sys.executable).resolve()}"


def digest() -> str:
    """Of everything that decides what is in .venv."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    parts = [project["project"], project["build-system"], project["dependency-groups"], sys.version_info[:2]]
    text = json.dumps(parts) + CONSTRAINTS.read_text(encoding="utf-8")
    return hashlib.sha256(text.encode()).hexdigest()


def requirements(purpose: str) -> list[str]:
    """What pip is asked for: the project itself, for tests with the group `dev`."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    group: list[str] = project["dependency-groups"]["dev"] if purpose == "test" else []
    return ["--constraint", str(CONSTRAINTS), "--editable", f".[{EXTRAS}]", *group]


def install_with_uv(purpose: str, *, anew: bool) -> bool:
    """Fill .venv with uv; False where uv is missing or cannot reach its packages."""
    if not works(["uv", "--version"]):
        return False
    made = not anew or run(["uv", "venv", "--clear", "--python", sys.executable, str(VENV)])
    return made and run(["uv", "pip", "install", "--python", str(PYTHON), *requirements(purpose)])


def install_with_pip(purpose: str, *, anew: bool) -> None:
    """Fill .venv with Python's own tools, or say why not and stop."""
    if not works([sys.executable, "-c", "import ensurepip"]):
        see_to_debian_packages("venv")
    clear = ["--clear"] if anew else []
    if not run([sys.executable, "-m", "venv", *clear, str(VENV)]):
        sys.exit("Python could not make .venv; it says why above.")
    if not run([str(PYTHON), "-m", "pip", "install", *requirements(purpose)]):
        sys.exit("pip could not install what BEATRIX needs; it says why above. Is this computer on line?")


def make_venv(purpose: str) -> None:
    """Make .venv, unless it is there and made from the same files; one for tests also serves the demo."""
    stamp = VENV / "made-from.json"
    made = json.loads(stamp.read_text(encoding="utf-8")) if stamp.exists() else {}
    if made.get("digest") == digest() and purpose in (made["purpose"], "demo"):
        return
    # A whole .venv of this Python is completed, not made anew: robots may be running from it.
    anew = made.get("python") != python()
    stamp.unlink(missing_ok=True)
    if not install_with_uv(purpose, anew=anew):
        install_with_pip(purpose, anew=anew)
    stamp.write_text(
        json.dumps({"digest": digest(), "purpose": purpose, "python": python()}), encoding="utf-8"
    )


def main() -> int:
    """Set this checkout up for one purpose."""
    if len(sys.argv) != 2 or sys.argv[1] not in PURPOSES:
        sys.exit(f"usage: python tools/setup.py {'|'.join(PURPOSES)}")
    purpose = sys.argv[1]
    if purpose == "test":
        see_to_debian_packages(purpose)
    make_venv(purpose)
    return 0


if __name__ == "__main__":
    sys.exit(main())
