"""Saved choices: shared by windows, and robust against damaged files."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_worlds import robot, world

from gui.console.state import intents, saved
from gui.console.state.intents import Theme
from gui.console.state.saved import Saved, SavedPose
from gui.console.state.state import State
from gui.window.run import Autosave


def test_choices_and_poses_are_those_of_the_previous_window(tmp_path: Path) -> None:
    file, now = tmp_path / "new" / "window.json", world(robot("sim", arms=(10, -5, 2.5)))
    state = State()
    for intent in (
        intents.Choose("theme", Theme.PROJECTOR),
        intents.Choose("language", "de"),
        intents.Choose("increment", 2.5),
        intents.Choose("speed", 45),
        intents.Choose("lead_s", 0),
        intents.AddPose("bow"),
    ):
        state.handle(intent, now)
    saved.save(file, state.saved)
    assert [path.name for path in file.parent.iterdir()] == ["window.json"]
    found = saved.load(file)
    assert found == Saved(Theme.PROJECTOR, "de", 2.5, 45, 0, poses=(SavedPose("bow", 10, -5, 2.5, 1.0),))
    view = State(found).view(now)
    chosen = view.choices
    assert (chosen.theme, chosen.language, view.sequence.cards[0].name) == (Theme.PROJECTOR, "de", "bow")
    assert (chosen.increment, chosen.speed, chosen.lead_s) == (2.5, 45, 0)


@pytest.mark.parametrize(
    "text", [b"", b"{", b"[]", b'{"theme": "pink"}', b'{"speed": -1}', b'{"lead_s": "2"}', b"\xff\xfe"]
)
def test_instead_of_a_damaged_file_the_defaults_are_used(tmp_path: Path, text: bytes) -> None:
    file = tmp_path / "window.json"
    file.write_bytes(text)
    assert saved.load(file) == Saved(simple=True)


def test_the_file_of_an_earlier_window_is_read(tmp_path: Path) -> None:
    file = tmp_path / "window.json"
    file.write_text(
        """{"theme": "light", "language": "de", "increment": 2.5, "speed": 45.0, "lead_s": 0.0,
        "poses": [{"name": "bow", "short": 10.0, "middle": -5.0, "long": 2.5, "duration_s": 1.0}],
        "send_on_release": true, "guided": 3}"""
    )
    found = saved.load(file)
    poses = (SavedPose("bow", 10, -5, 2.5, 1.0),)
    assert found == Saved(Theme.LIGHT, "de", 2.5, 45, 0, send_on_release=True, poses=poses, guided=3)
    assert State(found).saved == found


@pytest.mark.parametrize(
    ("platform", "environment", "path"),
    [
        ("linux", {"XDG_CONFIG_HOME": "/x"}, Path("/x/beatrix/window.json")),
        ("linux", {}, Path.home() / ".config/beatrix/window.json"),
        ("win32", {"APPDATA": "/roaming"}, Path("/roaming/beatrix/window.json")),
        ("darwin", {}, Path.home() / "Library/Application Support/beatrix/window.json"),
    ],
)
def test_each_platform_has_its_folder(platform: str, environment: dict[str, str], path: Path) -> None:
    assert saved.path(platform, environment) == path


# -- the file ----------------------------------------------------------------------------------------


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "beatrix" / "window.json"
    monkeypatch.setattr(saved, "path", lambda: path)
    return path


def test_a_saved_pose_survives_the_save_of_a_second_window(file: Path) -> None:
    one, two = State(), State()
    first, second = Autosave(one), Autosave(two)
    one.handle(intents.AddPose("nod"), world())
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
