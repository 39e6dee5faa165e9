"""What `beatrix up` tells people to type next."""

from __future__ import annotations

import msgspec
from statuses import READY

from beatrix_zenoh._generated.messages import Status
from beatrix_zenoh.cli.up import verbs


def status(*, calibrated: bool) -> Status:
    """Of a robot that rests."""
    return msgspec.structs.replace(READY, enabled=calibrated, calibrated=calibrated)


def test_up_tells_nobody_to_calibrate_a_robot_that_knows_home() -> None:
    knows, lost = status(calibrated=True), status(calibrated=False)
    assert verbs("", {"hw": knows}) == ["look --yaw 20", "top", "stop"]
    assert verbs("", {"hw": lost})[:2] == ["enable", "calibrate"]
    assert verbs("", {"sim": lost, "hw": knows})[:3] == [
        "enable --on sim",
        "calibrate --on sim",
        "look --yaw 20 --on both",
    ]
    assert verbs("", {"sim": lost, "hw": None})[:2] == ["enable --on both", "calibrate --on both"]
