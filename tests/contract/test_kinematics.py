"""The kinematics of the SDK are those of the robot."""

from __future__ import annotations

import pytest
from robots import assert_fails

from beatrix_zenoh import Robot
from beatrix_zenoh.client.degrees import bearing
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused


@pytest.mark.bodies("in-process")
def test_limits_and_geometry_are_in_degrees(robot: Robot) -> None:
    kinematics = robot.kinematics()
    assert (kinematics.limits, kinematics.geometry) == (robot.info().limits, robot.info().geometry)
    assert 30 <= kinematics.limits.tilt_max <= 90
    assert_fails(lambda: kinematics.inverse(pitch=80), Refused, Reason.OUT_OF_REACH)
    with pytest.raises(BeatrixError):
        kinematics.forward(0, 120, 0)


@pytest.mark.bodies("in-process", "mega")
def test_the_eyes_look_at_a_place(robot: Robot) -> None:
    robot.look_at(1.0, 0.5, 0.3, speed=60)
    yaw, pitch = bearing(1.0, 0.5, 0.3)
    assert robot.positions().head == pytest.approx((yaw, pitch, 0), abs=0.3)
