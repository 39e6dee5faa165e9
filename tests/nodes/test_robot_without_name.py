"""`Robot()` and `Twin()` without a name, as the command line chooses a robot."""

from __future__ import annotations

import pytest
from robots import Stage

from beatrix_zenoh import NoAnswer, Refused, Robot, Twin


def test_without_a_name_programs_use_the_only_robot_online(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("BEATRIX_ROBOT", raising=False)
    with Stage() as stage:
        with pytest.raises(NoAnswer, match="No robot is online"):
            Robot(connect=stage.endpoint)
        stage.node("bea")
        with Robot(side="hw", connect=stage.endpoint) as robot, Twin(connect=stage.endpoint) as twin:
            assert robot.status().robot == robot.name == twin.name == twin.hw.name == "bea"
        stage.node("bob")
        with pytest.raises(Refused, match="bea, bob"):
            Twin(connect=stage.endpoint)
