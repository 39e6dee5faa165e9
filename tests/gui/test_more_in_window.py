"""Parts of the window other than motions: poses, history, recordings, cameras, robots, themes, languages."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_windows import HOME, Windowed, near
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QLineEdit
from robots import Stage, until

from beatrix_zenoh import Robot
from beatrix_zenoh.recording.rrd.read import read
from gui.console.state.intents import Theme
from gui.window.theme import style_of

pytestmark = pytest.mark.qt_log_ignore("This plugin does not support")  # popups and dialogs without a display


# -- earlier poses --------------------------------------------------------------------------------


def test_undo_goes_back_step_by_step(user: Windowed, sim: Robot) -> None:
    user.send_to("sim")
    for arm in ("short", "long"):
        user.press(user.window.panels.arms.rows[arm].plus)
        user.until_last("done")
    user.press(user.window.panels.commands.buttons["undo"])
    user.until_at(sim, 5, 0, 0)
    user.until_last("undo", "done")
    user.key(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    user.until_at(sim, *HOME)


def test_poses_can_be_saved_reached_played_written_and_deleted(
    user: Windowed, sim: Robot, hw: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    panels, poses = user.window.panels, user.window.panels.poses
    panels.side.setCurrentWidget(poses)
    save_pose(user, "up")
    user.press(panels.arms.rows["all"].plus)
    user.until_last("done")
    save_pose(user, "left")
    poses.list.setCurrentRow(0)
    user.press(poses.go)
    for robot in (sim, hw):
        user.until_at(robot, *HOME)
    user.until_last("done")
    user.press(poses.play)
    for robot in (sim, hw):
        user.until_at(robot, 5, 5, 5)
    user.until_last("play 2 poses done")
    user.press(poses.save_file)
    accept_file(user, tmp_path / "mine.csv")
    user.until_last("save mine.csv done")
    user.press(poses.delete)
    assert [poses.list.item(row).text() for row in range(poses.list.count())] == ["left"]  # type: ignore[union-attr]
    user.send_to("sim")
    user.press(panels.arms.rows["all"].plus)
    user.until_last("move", "done")
    user.press(poses.play_file)
    accept_file(user, tmp_path / "mine.csv")
    user.until_last("play mine", "done")
    user.until_at(sim, 5, 5, 5)
    assert near(hw.positions().arms, (5, 5, 5))


def save_pose(user: Windowed, name: str) -> None:
    field = user.window.panels.poses.name
    field.setFocus()
    user.until(field.hasFocus, "the name has the focus")
    QTest.keyClicks(field, name)
    user.press(user.window.panels.poses.save)


def accept_file(user: Windowed, file: Path) -> None:
    """Type a path into the file dialog, and press Enter."""
    dialog = user.window.panels.poses.dialog
    assert dialog is not None
    field = dialog.findChild(QLineEdit, "fileNameEdit")
    assert field is not None
    field.selectAll()
    QTest.keyClicks(field, str(file))
    QTest.keyClick(field, Qt.Key.Key_Return)


def test_a_request_is_sent_again_and_copied(user: Windowed, sim: Robot) -> None:
    user.send_to("sim")
    history = user.window.panels.history
    user.press(user.window.panels.arms.rows["all"].plus)
    user.until_last("done")
    history.list.setCurrentRow(0)
    user.press(history.python)
    clipboard = QApplication.clipboard()
    assert clipboard is not None
    assert "move(5" in clipboard.text()
    user.press(history.command_line)
    assert clipboard.text().startswith("beatrix move")
    user.press(history.repeat)
    user.until_at(sim, 10, 10, 10)


# -- recording, cameras, and the window itself ----------------------------------------------------


def test_record_makes_a_recording(user: Windowed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    record = user.window.panels.header.record
    user.key(Qt.Key.Key_R, Qt.KeyboardModifier.ControlModifier)
    user.until(lambda: "0:01" in record.text.text(), "it runs", 30.0)
    user.press(user.window.panels.arms.rows["all"].plus)
    user.until_last("done")
    user.press(record.toggle)
    user.until(record.open.isVisible, "it has ended")
    (file,) = (tmp_path / "recordings").glob("bea-*.rrd")
    assert set(read(file).robots) == {("bea", "sim"), ("bea", "hw")}


def test_cameras_work_only_while_they_are_watched(user: Windowed, hw: Robot) -> None:
    panels = user.window.panels

    def streaming() -> list[bool]:
        return [camera.streaming for camera in hw.status().cameras]

    user.until(lambda: panels.heads.picture._newest is not None, "the head from outside")
    assert not any(streaming())
    panels.tabs.setCurrentWidget(panels.eyes)
    user.check(panels.sending.cameras)
    user.until(lambda: all(streaming()), "the cameras of the hardware work")
    pictures = [panels.eyes.pictures[side, eye] for side in ("sim", "hw") for eye in ("left", "right")]
    user.until(lambda: all(picture._newest is not None for picture in pictures), "all pictures")
    user.check(panels.sending.cameras, on=False)
    user.until(lambda: not any(streaming()), "they no longer stream")


def test_the_window_shows_and_commands_the_chosen_robot(user: Windowed, stage: Stage) -> None:
    header = user.window.panels.header
    user.until(lambda: header.robots.count() == 2, "both names")
    header.robots.setFocus()
    user.until(header.robots.hasFocus, "the list has the focus")
    user.key(Qt.Key.Key_Down)
    user.until(lambda: "other" in user.window.windowTitle(), "its name in the title")
    user.until(lambda: "motors off" in header.pills["hw"].state.text(), "its state")
    user.until(lambda: "not online" in header.pills["sim"].state.text(), "it has no simulation")
    user.press(header.pills["hw"].next_step)
    other = stage.robot("other", "hw")
    until(lambda: other.status().enabled, "it was enabled")


def test_the_menu_changes_theme_and_language(user: Windowed, sim: Robot) -> None:
    for theme in Theme:
        choose(user, theme.value)
        assert style_of(theme).ground in user.window.styleSheet()
    choose(user, "de")
    panels = user.window.panels
    user.until(panels.isVisible, "the new widgets")
    assert panels.commands.buttons["calibrate"].text() == "Kalibrieren"
    user.press(panels.arms.rows["all"].plus)
    user.until_at(sim, 5, 5, 5)
    choose(user, "en")
    assert user.window.panels.commands.buttons["calibrate"].text() == "Calibrate"


def choose(user: Windowed, name: str) -> None:
    """Choose an entry of the menu with the mouse."""
    header = user.window.panels.header
    user.press(header.menu_button)
    user.until(header.menu.isVisible, "the menu is open")
    place = header.menu.actionGeometry(header.choices[name]).center()
    QTest.mouseClick(header.menu, Qt.MouseButton.LeftButton, pos=QPoint(place))
