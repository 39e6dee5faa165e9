"""What `beatrix up` tells people to type next."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import BoardStatus, Fault, Status
from beatrix_zenoh.cli.up import verbs


def status(*, calibrated: bool) -> Status:
    """Of a robot that rests."""
    board = BoardStatus(
        connected=True,
        port="virtual:",
        name="",
        firmware="",
        contract="",
        boot=1,
        rejected_frames=0,
        retries=0,
    )
    return Status(
        t_mono_ns=0,
        t_wall_ns=0,
        robot="bea",
        twin="hw",
        enabled=calibrated,
        calibrated=calibrated,
        moving=False,
        motion=0,
        fault=Fault.NONE,
        warnings=[],
        calibrations=0,
        holder="",
        board=board,
    )


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
