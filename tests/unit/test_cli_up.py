"""The commands that `beatrix up` suggests."""

from __future__ import annotations

import msgspec
from statuses import READY

from beatrix_zenoh._generated.messages import Status
from beatrix_zenoh.cli.up import verbs


def status(*, calibrated: bool) -> Status:
    """Return the status of a robot at rest."""
    return msgspec.structs.replace(READY, enabled=calibrated, calibrated=calibrated)


def test_up_suggests_calibration_only_for_robots_that_are_not_calibrated() -> None:
    calibrated, uncalibrated = status(calibrated=True), status(calibrated=False)
    assert verbs("", {"hw": calibrated}) == ["look --yaw 20", "top", "stop"]
    assert verbs("", {"hw": uncalibrated})[:2] == ["enable", "calibrate"]
    assert verbs("", {"sim": uncalibrated, "hw": calibrated})[:3] == [
        "enable --on sim",
        "calibrate --on sim",
        "look --yaw 20 --on both",
    ]
    assert verbs("", {"sim": uncalibrated, "hw": None})[:2] == ["enable --on both", "calibrate --on both"]
