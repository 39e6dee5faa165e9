"""The log of a process with several robots: each line names its robot."""

from __future__ import annotations

from pathlib import Path

import pytest

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.logs import log_to
from beatrix_zenoh.node.events import NodeEvents, new_event
from beatrix_zenoh.threads import Owner


def test_an_event_names_its_robot_on_every_thread(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with log_to(tmp_path / "day.log", named=True):
        ada = NodeEvents(owner=Owner("ada"))
        ada.add(
            new_event(kind=EventKind.ROUTER, message="It is lost.")
        )  # as on a thread of Zenoh, which belongs to no robot
        with threads.owned_by(Owner("bob")):
            ada.add(new_event(kind=EventKind.ROUTER, message="It is back."))
    written = (tmp_path / "day.log").read_text(encoding="utf-8").splitlines()
    lines = [line.partition("events: ")[2] for line in written]
    assert lines == capfd.readouterr().err.splitlines() == ["ada: It is lost.", "ada: It is back."]
