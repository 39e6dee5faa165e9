"""The commands that `beatrix up` suggests, and the order in which its processes end."""

from __future__ import annotations

import pytest

from beatrix_zenoh import processes
from beatrix_zenoh.cli.serving import UpOptions, start_robots
from beatrix_zenoh.processes import Role, Supervisor
from beatrix_zenoh.settings import Settings


def test_robots_end_before_the_window_and_the_router_ends_last(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = []

    class FakeChild:
        """A child that is ready at once."""

        ready, code = True, None

        def __init__(
            self, title: str, _arguments: object, _log: object, role: Role, _environment: object
        ) -> None:
            self.title, self.role = title, role

        def end(self) -> None:
            ended.append(self.title)

    monkeypatch.setattr(processes, "Child", FakeChild)
    options = UpOptions({"sim": "MuJoCo", "hw": "virtual:"}, False, None, None, None, None, True)
    with Supervisor() as supervisor:
        supervisor.start("router")
        start_robots(supervisor, Settings("bea", "tcp/127.0.0.1:1", "ana"), options)
    assert ended == ["hardware", "simulation", "window", "router"]
