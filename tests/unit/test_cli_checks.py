"""The findings of `beatrix doctor` about this computer."""

from __future__ import annotations

from pathlib import Path

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh.cli import serving
from beatrix_zenoh.doctor import computer


def test_an_installed_version_outside_our_bounds_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(computer, "requirements", lambda: ["numpy>=99.0", "msgpack<99"])
    (_, finding) = computer.packages()
    assert finding.todo.startswith("it needs numpy>=99.0: pip install")


def test_graphics_that_cannot_draw_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "off")
    found = computer.graphics()
    assert "see nothing" in found.found
    assert found.state == "advice"


def test_a_port_without_permission_is_reported_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def ports(_folder: Path, pattern: str) -> list[Path]:
        return [Path("/dev/ttyACM0")] if pattern == "ttyACM*" else []

    monkeypatch.setattr(Path, "glob", ports)
    monkeypatch.setattr("os.access", lambda *_: False)
    (finding,) = computer.serial_ports()
    assert "dialout" in finding.todo


def test_cameras_are_listed_by_their_path(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(computer, "VIDEO_DEVICES", tmp_path)
    assert list(computer.cameras()) == []
    for name in ("usb-0:1:1.0-video-index0", "usb-0:1:1.0-video-index1"):  # the second delivers no pictures
        (tmp_path / name).touch()
    (finding,) = computer.cameras()
    assert (finding.found, finding.todo) == (
        f"{tmp_path}/usb-0:1:1.0-video-index0: this user may open it",
        "",
    )
    monkeypatch.setattr("os.access", lambda *_: False)
    (finding,) = computer.cameras()
    assert "usermod -aG video" in finding.todo


def test_the_error_for_a_program_that_the_installation_lacks_says_how_to_renew_it() -> None:
    with pytest.raises(Refused, match="`beatrix other` is newer than the installation"):
        serving.run("other", [])


def test_the_error_for_a_missing_library_names_it_and_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    class Entry:
        def load(self) -> None:
            raise ModuleNotFoundError("No module named 'mujoco'", name="mujoco")

    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: [Entry()])
    with pytest.raises(Refused, match=r"needs mujoco.*beatrix install sim"):
        serving.run("sim", [])
