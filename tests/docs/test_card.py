"""The card for the desks has the limits of the robot, and commands that exist."""

from __future__ import annotations

import re
from pathlib import Path

from beatrix_zenoh.cli import verbs
from beatrix_zenoh.contract._generated.robot import ROBOT

CARD = Path(__file__).resolve().parents[2] / "docs/lessons/card.html"
SIDES = CARD.read_text(encoding="utf-8").split("<section")[1:]


def test_both_sides_of_the_card_have_the_limits_of_the_robot() -> None:
    limits = ROBOT.limits
    asked = [limits.tilt_max, limits.yaw_max, limits.gap_min, limits.speed_default, limits.speed_max]
    assert len(SIDES) == 2
    for side in SIDES:
        table = re.search(r"<h2>(?:Limits|Grenzen)</h2>(.*?)</table>", side, re.DOTALL)
        assert table is not None
        assert [float(number) for number in re.findall(r"(\d+)°", table[1])] == asked


def test_commands_of_the_card_exist() -> None:
    named = {verb for side in SIDES for verb in re.findall(r"<code>beatrix (\w+)", side)}
    assert len(named) > 8
    assert named <= set(verbs.VERBS)
