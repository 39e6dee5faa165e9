"""Tables of `ls` and `top` about robots that any program may imitate."""

from __future__ import annotations

import msgspec
import pytest
from statuses import READY

from beatrix_zenoh.cli.listing import TableRow, cells, notes, show
from beatrix_zenoh.contract._generated.messages import Fault, Status
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.states import CELL, PROBLEM, WARNINGS, ListedRobot, problems, some

LONG = "x" * 1000
HOSTILE = msgspec.structs.replace(
    READY,
    holder=LONG,
    warnings=[LONG] * 200,
    waiting=[f"seat-{number}" for number in range(500)],
    muted=["y" * 32] * 500,
    lease=1,
)


@pytest.mark.parametrize("status", [HOSTILE, msgspec.structs.replace(HOSTILE, fault=Fault.BOARD_LOST)])
def test_a_foreign_status_prints_a_bounded_number_of_short_lines(
    status: Status, capsys: pytest.CaptureFixture[str]
) -> None:
    show([ListedRobot((LONG, "hw"), status, None)])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) < WARNINGS + 10
    assert max(len(line) for line in lines[:2]) < 4 * CELL
    found = problems(status)
    assert max(map(len, found)) <= PROBLEM
    assert f"It has {200 - WARNINGS} more warnings." in found
    row = TableRow(("bea", "hw"), LONG, None, 50.0, None, LONG, {}, found)
    assert max(map(len, cells(resolve(None, None, None), row))) == CELL
    assert len(notes([row])) == len(found)


def test_an_ordinary_status_is_shown_in_full() -> None:
    warnings = [f"Warning {number}." for number in range(WARNINGS)]
    assert problems(msgspec.structs.replace(READY, warnings=warnings)) == warnings
    assert some(["ana", "ben"]) == "ana, ben"
    assert some(["ana", "ben", "cleo", "dan"], 2) == "ana, ben, and 2 more"
