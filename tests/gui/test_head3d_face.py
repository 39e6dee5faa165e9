"""The face of a robot: it sleeps while the motors are off, peeks at the mouse, and wakes up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from gui_worlds import robot, status, world
from PyQt5.QtGui import QCursor
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.head_shape import AWAKE, Face
from beatrix_zenoh.contract._generated.robot import COLOURS, ROBOT, SIZES
from gui.window.widgets.head3d import ATTENTION, CLOSED, WAKING, Lids
from gui.window.window import Window


def sleeping() -> Lids:
    lids = Lids()
    lids.show(asleep=True)
    lids.step(0.0, 0.0)
    return lids


@pytest.mark.parametrize(
    ("left", "down", "gaze"),
    [
        (0.0, 1.0, (0.0, 0.0)),
        (-900.0, 0.0, (-1.0, 0.0)),
        (150.0, 10.0, (0.5, 0.0)),
        (0.0, -900.0, (0.0, 0.5)),
    ],
)
def test_a_sleeping_robot_peeks_at_the_mouse_until_it_rests(
    left: float, down: float, gaze: tuple[float, float]
) -> None:
    lids = sleeping()
    assert lids.face == CLOSED
    lids.step(left, down)
    assert lids.face == Face(0.5, *gaze)
    seen = []
    for _ in range(ATTENTION):
        lids.step(left, down)
        seen.append(lids.face)
    assert CLOSED in seen[:-2], "it blinks"
    assert lids.face == CLOSED


def test_a_robot_that_can_move_looks_straight_ahead_as_its_cameras_do() -> None:
    lids = sleeping()
    lids.show(asleep=False)
    seen = [lids.face]
    while lids.moves:
        lids.step(200.0, 100.0)
        seen.append(lids.face)
    assert tuple(seen) == WAKING
    lids.step(-200.0, 0.0)
    assert lids.face == AWAKE == Face()


def test_the_eyes_of_the_mesh_are_where_the_cameras_are() -> None:
    (head,) = (mesh for mesh in meshes(Figure()) if mesh.body == "head")
    pupils = head.points[(head.colours == COLOURS.black).all(axis=1)]
    for side in (1, -1):
        middle = pupils[pupils[:, 1] * side > 0].mean(axis=0)
        expected = (side * ROBOT.head.eye_baseline / 2, ROBOT.head.centre_height + SIZES.eye_up)
        assert middle[1:] == pytest.approx(expected, abs=1e-4)
    (closed,) = (mesh for mesh in meshes(Figure(), face=CLOSED) if mesh.body == "head")
    assert not (closed.colours == COLOURS.black).all(axis=1).any()
    assert np.abs(closed.points).max() < 0.3


def test_the_window_moves_the_lids_only_while_the_robot_sleeps(
    qtbot: QtBot, window: Window, link: RecordingLink
) -> None:
    panel, ready = window.panels.head3d, link.known
    assert not panel._blinks.isActive()
    link.known = world(*(robot(side, known=status(side, enabled=False)) for side in ("sim", "hw")))
    window.refresh()
    assert panel._lids.face == CLOSED
    QCursor.setPos(panel.mapToGlobal(panel.rect().center()))
    qtbot.waitUntil(panel._blinks.isActive)
    link.known = replace(ready)
    window.refresh()
    qtbot.waitUntil(lambda: panel._lids.face == AWAKE and not panel._blinks.isActive())
