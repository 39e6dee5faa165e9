"""The generated table and tree of docs/explanation/neck.md agree with the kinematics and the model."""

from __future__ import annotations

import math
import re

import neck_page
import pytest

from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.trajectory import plan
from sim_node.model import build_spec

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
