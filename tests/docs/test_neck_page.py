"""The generated table and tree of docs/explanation/neck.md agree with the kinematics and the model."""

from __future__ import annotations

import math
import re

import neck_page

from beatrix_zenoh.motion.kinematics import Neck

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
