"""What `beatrix doctor` finds on this computer."""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh.cli import checks, serving


def test_missing_extra_is_advice_with_the_line_to_type(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.metadata.requires", lambda _: ["numpy>=2", 'no-such>=1; extra == "plot"'])
    found = {finding.what: finding for finding in checks.packages()}
    assert found["core"].advice == ""
    assert "no-such" in found["extra plot"].found
    assert 'pip install ".[plot]"' in found["extra plot"].advice


def test_sources_that_are_not_installed_are_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(name: str) -> list[str]:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.requires", unknown)
    (finding,) = checks.packages()
    assert "pip install" in finding.todo


def test_a_module_that_hides_ours_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "hw_node.py").write_text("", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "hw_node", raising=False)
    (finding,) = checks.hidden_packages()
    assert finding.what == "package hw_node"
    assert str(tmp_path / "hw_node.py") in finding.found
    assert "rename" in finding.todo


def test_nothing_is_hidden_normally() -> None:
    assert list(checks.hidden_packages()) == []


def test_missing_graphics_is_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("ctypes.util.find_library", lambda _: None)
    assert "ray casting" in checks.graphics().found


def test_a_port_that_may_not_be_opened_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def ports(_folder: Path, pattern: str) -> list[Path]:
        return [Path("/dev/ttyACM0")] if pattern == "ttyACM*" else []

    monkeypatch.setattr(Path, "glob", ports)
    monkeypatch.setattr("os.access", lambda *_: False)
    (finding,) = checks.serial_ports()
    assert "dialout" in finding.todo


def test_a_process_that_is_not_installed_names_its_extra() -> None:
    with pytest.raises(Refused, match=r'pip install "\.\[gui\]"'):
        serving.run("gui", [])


def test_a_process_that_lacks_a_library_names_it_and_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    class Entry:
        def load(self) -> None:
            raise ModuleNotFoundError("No module named 'mujoco'", name="mujoco")

    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: [Entry()])
    with pytest.raises(Refused, match=r'needs mujoco.*pip install "\.\[sim\]"'):
        serving.run("sim", [])
