"""The archive for a room without a network: it installs and runs there, and names the packages of other platforms."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import bundle
import pytest

ISOLATED = ["unshare", "--map-root-user", "--net"]
"""Runs a program with no network at all, not even loopback."""


@pytest.mark.long("builds and installs an archive")
@pytest.mark.timeout(280)
def test_a_bundle_installs_and_runs_without_network(tmp_path: Path) -> None:
    if subprocess.run([*ISOLATED, "true"], check=False).returncode:
        pytest.skip("this computer permits no network namespaces")
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    archive = bundle.bundle(bundle.here(), python, ["cli"], tmp_path / "made")
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(tmp_path / "stick")
    (folder,) = (tmp_path / "stick").iterdir()
    home = tmp_path / "home"
    subprocess.run([*ISOLATED, sys.executable, folder / "install.py", home], check=True)
    done = subprocess.run(
        [*ISOLATED, home / "bin/beatrix", "ls"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 3, "no answer: there is no router"
    assert "No router at" in done.stderr


def test_the_packages_for_windows_are_pinned() -> None:
    values = bundle.environment("windows-x86_64", "3.12")
    names = bundle.names_of(list(bundle.own_requirements(["all"])), values)
    assert {"opencv-python-headless", "mujoco", "pyqt5", "rerun-sdk", "colorama", "pandas"} <= names
    assert names <= bundle.pins(values).keys()
