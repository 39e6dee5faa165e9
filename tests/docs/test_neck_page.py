"""The generated table and tree of docs/explanation/neck.md agree with the kinematics and the model."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import neck_page
import numpy as np
import numpy.typing as npt
import pytest

from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.trajectory import plan
from sim_node.model import build_spec

Vector = npt.NDArray[np.float64]

TEXT = neck_page.PAGE.read_text(encoding="utf-8")


def test_the_page_is_as_generated() -> None:
    assert neck_page.page(TEXT) == TEXT, "run python tools/neck_page.py"


def test_the_head_angles_of_each_row_belong_to_its_arm_angles() -> None:
    rows = dict(re.findall(r"^\| ([a-z ,]+) \| (.*°) \|$", TEXT, re.MULTILINE))
    for title, pattern in neck_page.PATTERNS:
        yaw, pitch, roll = (math.radians(float(angle.strip(" °"))) for angle in rows[title].split("|"))
        arms = [math.degrees(angle) for angle in Neck().inverse(yaw, pitch, roll)]
        expected = [neck_page.TURN_DEG * share for share in pattern]
        assert all(abs(arm - goal) < 0.2 for arm, goal in zip(arms, expected, strict=True)), title


def test_the_tree_names_every_body_joint_motor_and_loop() -> None:
    model = build_spec().compile()
    names = [model.body(i).name for i in range(model.nbody)]
    names += [model.actuator(i).name for i in range(model.nu)]
    names += [model.equality(i).name for i in range(model.neq)]
    tree = TEXT.split("<!-- begin model")[1]
    assert all(re.search(rf"\b{name}\b", tree) for name in names)


def values_of_the_page() -> dict[str, float]:
    """Return the geometry as docs/reference/robot.md gives it, angles in rad."""
    text = (neck_page.DOCS / "reference/robot.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\w+) \| ([-+.\de]+) \| (deg|) \|", text, re.MULTILINE)
    return {name: math.radians(float(value)) if unit else float(value) for name, value, unit in rows}


def along(azimuth: float, polar: float, up: float) -> Vector:
    """Return the unit vector at an angle from the vertical axis, which points up (1) or down (-1)."""
    across = math.sin(polar)
    return np.array((across * math.cos(azimuth), across * math.sin(azimuth), up * math.cos(polar)))


def head_of(arms: Sequence[float], elbows_up: float) -> Vector:
    """Return yaw, pitch and roll (rad) for arm angles (rad), computed from the page alone by Newton's method."""
    page = values_of_the_page()
    azimuths = [page["arm0_azimuth"] + i * page["arm_spacing"] for i in range(3)]
    twist, mount = math.cos(page["rod_twist"]), page["mount_angle"]
    elbows = [along(azimuth, page["arm_angle"], elbows_up) for azimuth in azimuths]
    level = (twist - elbows[0][2] * math.cos(mount)) / (math.sin(page["arm_angle"]) * math.sin(mount))
    mounts = [along(azimuth + page["hand"] * math.acos(level), mount, 1.0) for azimuth in azimuths]
    moved = [
        along(azimuth + arm, page["arm_angle"], elbows_up)
        for azimuth, arm in zip(azimuths, arms, strict=True)
    ]

    def open_by(head: Vector) -> Vector:
        yaw, pitch, roll = head
        turn = about("z", yaw) @ about("y", pitch) @ about("x", roll)
        return np.array([elbow @ turn @ mount - twist for elbow, mount in zip(moved, mounts, strict=True)])

    head = np.array((sum(arms) / 3, 0.0, 0.0))
    for _ in range(30):
        slopes = np.column_stack(
            [(open_by(head + step) - open_by(head - step)) / 2e-6 for step in 1e-6 * np.eye(3)]
        )
        head = head - np.linalg.solve(slopes, open_by(head))
    return head


def about(axis: str, angle: float) -> Vector:
    """Return the matrix of a rotation by an angle (rad)."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[j, i], turn[i, j] = math.sin(angle), -math.sin(angle)
    return turn


@pytest.mark.parametrize(("title", "pattern"), neck_page.PATTERNS)
def test_a_reader_can_compute_the_table_from_the_page_of_the_robot(
    title: str, pattern: Sequence[float]
) -> None:
    (row,) = re.findall(rf"^\| {title} \| (.*°) \|$", TEXT, re.MULTILINE)
    printed = [float(angle.strip(" °")) for angle in row.split("|")]
    arms = [math.radians(neck_page.TURN_DEG * share) for share in pattern]
    assert np.degrees(head_of(arms, elbows_up=-1.0)) == pytest.approx(printed, abs=0.051)
    if len(set(pattern)) > 1:
        assert np.degrees(head_of(arms, elbows_up=1.0)) != pytest.approx(printed, abs=1.0), (
            "the direction of the elbows, which the page states, matters"
        )


def test_different_speeds_tilt_the_head_only_on_the_way() -> None:
    path = neck_page.uneven_path()
    tilts = [
        neck_page.tilt((math.radians(a.short), math.radians(a.middle), math.radians(a.long)))
        for a in path.arms
    ]
    assert tilts[0] == pytest.approx(0.0, abs=1e-3)
    assert tilts[-1] == pytest.approx(0.0, abs=1e-3)
    assert 5 < max(tilts) < 10
    assert all(head.pitch > -0.01 for head in path.head), "the head nods"
    together = plan((0.0,) * 3, (0.0,) * 3, (0.7,) * 3, (0.7,) * 3, 3.0, straight=True)
    assert all(
        neck_page.tilt(together.at(together.duration * step / 20)[0]) == pytest.approx(0.0, abs=1e-3)
        for step in range(21)
    )
    shown = f"robot.move({', '.join([f'{neck_page.SWING_DEG:.0f}'] * 3)}, speed={tuple(map(int, neck_page.SPEEDS))})"
    assert shown in TEXT
