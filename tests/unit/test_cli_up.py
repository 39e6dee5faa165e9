"""The commands that `beatrix up` suggests, and the order in which its processes end."""

from __future__ import annotations

import msgspec
import pytest
from statuses import READY

from beatrix_zenoh import processes
from beatrix_zenoh.cli.serving import UpOptions, start_robots, verbs
from beatrix_zenoh.contract._generated.messages import Status
from beatrix_zenoh.processes import Role, Supervisor
from beatrix_zenoh.settings import Settings


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


def test_robots_end_before_the_window_and_the_router_ends_last(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = []

    class FakeChild:
        """A child that is ready at once."""

        ready, code = True, None

        def __init__(self, title: str, _arguments: object, _log: object, role: Role) -> None:
            self.title, self.role = title, role

        def end(self) -> None:
            ended.append(self.title)

    monkeypatch.setattr(processes, "Child", FakeChild)
    options = UpOptions({"sim": "MuJoCo", "hw": "virtual:"}, False, None, None, None, None, True)
    with Supervisor() as supervisor:
        supervisor.start("router")
        start_robots(supervisor, Settings("bea", "tcp/127.0.0.1:1", "ana"), options)
    assert ended == ["hardware", "simulation", "window", "router"]
