"""The file of choices: written on changes, and shared by windows."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_worlds import world

from gui.console.state import intents, saved
from gui.console.state.intents import Theme
from gui.console.state.state import State
from gui.window.run import Autosave


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "beatrix" / "window.json"
    monkeypatch.setattr(saved, "path", lambda: path)
    return path


def test_a_saved_pose_survives_the_save_of_a_second_window(file: Path) -> None:
    one, two = State(), State()
    first, second = Autosave(one), Autosave(two)
    one.handle(intents.SavePose("nod"), world())
    first.save_changes()
    assert [pose.name for pose in saved.load(file).poses] == ["nod"]
    two.handle(intents.Choose("theme", Theme.PROJECTOR), world())
    second.save_changes()
    first.save_changes()
    kept = saved.load(file)
    assert ([pose.name for pose in kept.poses], kept.theme) == (["nod"], Theme.PROJECTOR)
    one.handle(intents.DeletePose("nod"), world())
    first.save_changes()
    kept = saved.load(file)
    assert (kept.poses, kept.theme) == ((), Theme.PROJECTOR)
