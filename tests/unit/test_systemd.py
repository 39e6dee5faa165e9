"""Reports to systemd that a node works."""

from __future__ import annotations

import select
import socket
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import Mock

import pytest

from beatrix_zenoh.node.requests import ControllerQueue
from beatrix_zenoh.node.systemd import ADDRESS, SystemdReports
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.threads import Owner

OWNER = Owner("bea")
pytestmark = pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="systemd is of Linux")


@pytest.fixture
def systemd(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[socket.socket]:
    """Receive what a service reports."""
    monkeypatch.setenv(ADDRESS, str(tmp_path / "notify"))
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as receiver:
        receiver.bind(str(tmp_path / "notify"))
        receiver.settimeout(5.0)
        yield receiver


@pytest.fixture
def clock() -> Iterator[Schedule]:
    schedule = Schedule("clock")
    yield schedule
    schedule.close()


def test_a_report_needs_the_threads_of_clock_and_controller(systemd: socket.socket, clock: Schedule) -> None:
    queue = ControllerQueue()
    reports = SystemdReports(queue, OWNER, clock)
    reports.start(Mock())
    entry = queue.take()  # posted by the clock's thread
    assert entry is not None
    assert not select.select([systemd], [], [], 0.0)[0]
    entry()  # as the controller's thread does
    assert systemd.recv(99) == b"READY=1\nWATCHDOG=1"
    reports.close()
    assert not clock.serves(OWNER)


def test_a_node_outside_of_systemd_reports_nothing(clock: Schedule, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(ADDRESS, raising=False)
    SystemdReports(ControllerQueue(), OWNER, clock).start(Mock())
    assert not clock.serves(OWNER)
