"""The parts of the SDK for lessons: log and preview."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from robots import until

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh.contract.errors import WrongUsage


def test_a_log_has_what_the_robot_did(robot: Robot, tmp_path: Path) -> None:
    with robot.log() as log:
        assert "still open" in repr(log)
        with pytest.raises(AttributeError, match="still open"):
            _ = log.yaw
        with pytest.raises(WrongUsage, match="still open"):
            log.plot()
        robot.look(yaw=12, pitch=5)
        at_goal = robot.positions()
        with robot.stream() as stream:  # publications may arrive later than the reply
            until(lambda: stream.next().commanded == at_goal.commanded, "the goal is published")
    assert log.t[0] == 0
    assert np.all(np.diff(log.t) > 0)
    assert log.commanded_yaw[0] == pytest.approx(0, abs=0.1)
    assert log.commanded_yaw.max() == pytest.approx(12, abs=0.2)
    assert log.commanded_pitch.max() == pytest.approx(5, abs=0.2)
    assert log.yaw.max() > 5
    assert log.began_s < at_goal.t
    assert "pose" in [event.action for event in log.events]  # the end may be published after its reply
    log.save(tmp_path / "x.csv")
    with (tmp_path / "x.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["short_deg"]) for row in rows] == pytest.approx(log.short, abs=1e-5)
    assert len(log.plot().axes) == 2
    with pytest.raises(WrongUsage, match="does not end with"):
        log.save(tmp_path / "x.xlsx")


@pytest.mark.bodies("in-process")
def test_a_log_that_is_too_long_begins_later(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beatrix_zenoh.client.log.LENGTH", 20)
    with robot.log() as log:
        robot.look(yaw=20)
    assert len(log.t) + log.repeated <= 20 < log.dropped + 20
    assert log.t[0] == 0
    assert log.commanded_yaw[0] > 1
    assert not [gap for gap in log.gaps if gap.lost]


@pytest.mark.bodies("in-process")
def test_a_preview_of_the_hardware_names_the_simulation(robot: Robot) -> None:
    with pytest.raises(WrongUsage, match="asks its simulation"):
        robot.preview(yaw=20)


@pytest.mark.bodies("sim")
def test_a_preview_tries_what_look_would_do(robot: Robot) -> None:
    preview = robot.preview(yaw=20, pitch=10)
    assert preview.path.head[-1].yaw == pytest.approx(20, abs=0.5)
    assert preview.path.t[-1] == pytest.approx(preview.duration, abs=0.1)
    assert 10 <= preview.tilt_max < 12
    assert robot.positions().commanded.short == pytest.approx(0, abs=0.1)
    with pytest.raises(Refused):
        robot.preview(pitch=60)
