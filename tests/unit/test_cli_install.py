"""`beatrix install`: which command it runs."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

from beatrix_zenoh import Refused
from beatrix_zenoh.cli import install

UV = [sys.executable, "-P", "-m", "uv", "pip", "install", "--python", sys.executable]
SYSTEM_UV = ["uv", "pip", "install", "--python", sys.executable]
PIP = [sys.executable, "-P", "-m", "pip", "install"]


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The commands that were run; none of them does anything."""
    commands: list[list[str]] = []

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[bytes]:
        commands.append(command)
        return subprocess.CompletedProcess(command, 1 if "beatrix-zenoh[video]" in command else 0)

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(install, "extras_known", lambda: ["gui", "video"])
    return commands


def having(modules: set[str], programs: set[str]) -> tuple[Callable[[str], object], Callable[[str], object]]:
    """Return what finds these modules, and what finds these programs."""
    return (lambda name: name if name in modules else None), (lambda name: name if name in programs else None)


@pytest.mark.parametrize(
    ("modules", "programs", "command"),
    [({"uv", "pip"}, {"uv"}, UV), ({"pip"}, {"uv"}, SYSTEM_UV), ({"pip"}, set(), PIP)],
)
def test_the_fastest_installer_is_used_with_the_versions_of_the_sources(
    monkeypatch: pytest.MonkeyPatch,
    ran: list[list[str]],
    modules: set[str],
    programs: set[str],
    command: list[str],
) -> None:
    find_module, find_program = having(modules, programs)
    monkeypatch.setattr("importlib.util.find_spec", find_module)
    monkeypatch.setattr("shutil.which", find_program)
    install.install(["gui"])
    constraints = Path(__file__).parent.parent.parent / "constraints.txt"
    assert ran == [[*command, "beatrix-zenoh[gui]", "--constraint", str(constraints)]]


def test_a_wrong_name_and_a_missing_installer_are_refused(
    monkeypatch: pytest.MonkeyPatch, ran: list[list[str]]
) -> None:
    with pytest.raises(typer.BadParameter, match="'window' is none of gui, video"):
        install.install(["gui", "window"])
    with pytest.raises(typer.BadParameter, match="Choose from gui, video"):
        install.install()
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(Refused, match="neither uv nor pip"):
        install.install(["gui"])
    assert ran == []


def test_a_failed_installation_is_said(ran: list[list[str]], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit) as end:
        install.install(["video"])
    assert (len(ran), end.value.exit_code) == (1, 1)
    assert "video is not installed" in capsys.readouterr().err
