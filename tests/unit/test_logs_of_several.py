"""The log of a process with several robots: each line names its robots."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

import pytest

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.logs import log_to
from beatrix_zenoh.node.events import NodeEvents
from beatrix_zenoh.threads import Owner

LOST = "The router was lost."


def written(
    path: Path, capfd: pytest.CaptureFixture[str], work: Callable[[], None]
) -> tuple[list[str], list[str]]:
    """Return what is written to file and stderr while some work is done; of the file without time and logger."""
    with log_to(path, named=True):
        work()
    lines = [line.partition("events: ")[2] for line in path.read_text(encoding="utf-8").splitlines()]
    return lines, capfd.readouterr().err.splitlines()


def test_an_event_names_its_robot_on_every_thread(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    def work() -> None:
        ada = NodeEvents(owner=Owner("ada"))
        ada.add(EventKind.ROUTER, message=LOST)  # as on a thread of Zenoh, which belongs to no robot
        with threads.owned_by(Owner("bob")):
            ada.add(EventKind.ROUTER, message="It is back.")

    lines, printed = written(tmp_path / "day.log", capfd, work)
    assert lines == printed == [f"ada: {LOST}", "ada: It is back."]


def test_equal_warnings_of_several_robots_are_one_printed_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("beatrix_zenoh.logs.GATHER_S", 60.0)  # on a busy computer, too, the end comes first

    def work() -> None:
        for name in ("bob", "ada", "bob"):
            NodeEvents(owner=Owner(name)).add(EventKind.ROUTER, message=LOST)
        logging.getLogger("beatrix_zenoh.node.events").warning("A warning of the process.")

    lines, printed = written(tmp_path / "day.log", capfd, work)
    assert lines == [f"bob: {LOST}", f"ada: {LOST}", f"bob: {LOST}", "A warning of the process."]
    assert printed == [f"ada, bob: {LOST}", "A warning of the process."]


def test_a_gathered_warning_is_printed_although_nothing_follows(capfd: pytest.CaptureFixture[str]) -> None:
    with log_to(None, named=True):
        NodeEvents(owner=Owner("ada")).add(EventKind.ROUTER, message=LOST)
        printed = ""
        while not printed:  # ended by the time limit of tests
            printed = capfd.readouterr().err
    assert printed == f"ada: {LOST}\n"
