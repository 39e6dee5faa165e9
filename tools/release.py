"""Build and check a release in build/release: wheel, sdist, bill of materials and their SHA-256. Nothing is uploaded.

`make release`, in a clean clone. It ends at the first fault, and names it.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import house

ROOT: Final = Path(__file__).resolve().parents[1]
OUT: Final = ROOT / "build/release"
TWINE: Final = "twine==7.0.0"
"""Checks the metadata as the package index does; in an environment of its own, because it needs 30 packages."""
FOUNDATION: Final = (
    "LICENSE",
    "README.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "pyproject.toml",
    "constraints.txt",
)


def run(*command: str | Path, cwd: Path = ROOT) -> str:
    """Run a command for at most 5 minutes, and return its output; exit with it if the command fails."""
    print("+", *command, flush=True)
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False, timeout=300)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return done.stdout


def version() -> str:
    """Return the version; exit if changelog or CITATION.cff do not have it, or the clone has other changes."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = str(project["version"])
    if f"\n## [{found}] - 2" not in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"):
        sys.exit(
            f"CHANGELOG.md has no line `## [{found}] - DATE`. Write it above the changes of this version."
        )
    if f"\nversion: {found}\n" not in (ROOT / "CITATION.cff").read_text(encoding="utf-8"):
        sys.exit(
            f"CITATION.cff has no line `version: {found}`. Write it, and the date of the release below it."
        )
    if changes := run("git", "status", "--porcelain"):
        sys.exit(f"A release is built from what is committed. Commit or remove first:\n{changes}")
    return found


def wheel_faults(wheel: Path) -> Iterator[str]:
    """Yield what is wrong with the contents of a wheel: foreign folders, missing licences."""
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    packages = {name for name in house.PACKAGES if (ROOT / name).is_dir()}
    yield from (f"{wheel.name} contains {name}" for name in tops - packages)
    yield from (f"{wheel.name} lacks {name}" for name in packages - tops)
    for licence in (ROOT / "LICENSE", *ROOT.glob("gui/page/static/vendor/*/LICENSE")):
        path = licence.relative_to(ROOT).as_posix()
        if not any(name.endswith(f".dist-info/licenses/{path}") for name in names):
            yield f"{wheel.name} lacks the licence {path}"


def sdist_faults(sdist: Path, wheel: Path) -> Iterator[str]:
    """Yield what the sdist lacks, and the files that differ in a wheel that is built from it."""
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(sdist) as archive:
            archive.extractall(folder, filter="data")
        (source,) = Path(folder).iterdir()
        yield from (f"{sdist.name} lacks {name}" for name in FOUNDATION if not (source / name).exists())
        build("wheel", Path(folder) / "out", source)
        (again,) = (Path(folder) / "out").glob("*.whl")
        first, second = contents(wheel), contents(again)
    for name in sorted({name for name, _ in first.items() ^ second.items()}):
        yield f"{name} differs in the wheel that is built from {sdist.name}"


def contents(wheel: Path) -> dict[str, bytes]:
    """Return the SHA-256 of each file of a wheel."""
    archive = zipfile.ZipFile(wheel)
    return {name: hashlib.sha256(archive.read(name)).digest() for name in archive.namelist()}


def build(kind: str, out: Path, source: Path = ROOT) -> None:
    """Build the wheel or the sdist of a folder, without network."""
    run(sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", out, cwd=source)


def uv() -> list[str]:
    """Return the command of uv; exits if there is none."""
    if shutil.which("uv"):
        return ["uv"]
    if (
        subprocess.run([sys.executable, "-m", "uv", "--version"], capture_output=True, check=False).returncode
        == 0
    ):
        return [sys.executable, "-m", "uv"]
    sys.exit(f"There is no uv, which runs twine. Type `{sys.executable} -m pip install uv`, then try again.")


def main() -> None:
    print("BEATRIX", number := version())
    shutil.rmtree(OUT, ignore_errors=True)
    for kind in ("wheel", "sdist"):
        build(kind, OUT)
    (wheel,), (sdist,) = OUT.glob(f"*-{number}-*.whl"), OUT.glob(f"*-{number}.tar.gz")
    if faults := [*wheel_faults(wheel), *sdist_faults(sdist, wheel)]:
        sys.exit("\n".join(faults))
    print(run(*uv(), "tool", "run", TWINE, "check", "--strict", wheel, sdist), end="")
    run(sys.executable, "tools/licences.py", "--check")
    run(sys.executable, "tools/licences.py", "--sbom", OUT / "sbom.cdx.json")
    made = sorted(OUT.iterdir())
    sums = "".join(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in made)
    (OUT / "SHA256SUMS").write_text(sums, encoding="ascii")
    for path in made:
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e6:.1f} MB")
    print(
        f"The wheel from the sdist is the same. Next: git tag v{number}, and hand out the files of build/release."
    )


if __name__ == "__main__":
    main()
