"""The rule for a test that measures time on a computer that stood still meanwhile.

A failure is excused, and counts as skipped, only if all of this holds: the test has the mark `measures_time`; it failed
because `within` or `in_time` found a time above its limit, so that a wrong value or a timeout is never excused; and
without the pauses that the witness measured, the time was below the limit. A run excuses at most MOST tests, and prints
each with its figures. With xdist, the controller counts.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager

import pytest
from stall_monitor import Witness

MOST = 3
"""Excused tests of a run; further ones fail."""
PROPERTY = "excuse"
"""Name of the property of a report with the figures of a failure that may be excused."""
BEGIN_S = pytest.StashKey[float]()
"""Start time of a test (s), monotonic clock."""


class Late(AssertionError):
    """A time above its limit."""

    def __init__(self, what: str, took_s: float, limit_s: float) -> None:
        super().__init__(f"{what}: {took_s:.2f} s, at most {limit_s:.2f} s")
        self.took_s, self.limit_s = took_s, limit_s


def in_time(took_s: float, limit_s: float, what: str) -> None:
    """Raise Late if a measured time is above its limit."""
    if took_s > limit_s:
        raise Late(what, took_s, limit_s)


@contextmanager
def within(limit_s: float, what: str) -> Iterator[None]:
    """Raise Late if the block takes longer than `limit_s`."""
    began_s = time.monotonic()
    yield
    in_time(time.monotonic() - began_s, limit_s, what)


class Excuses:
    """Hooks of pytest. `counts` is false in a worker of xdist, whose controller decides."""

    def __init__(self, *, counts: bool) -> None:
        self.witness: Witness | None = None
        self._counts = counts
        self._excused: list[str] = []

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Store the start time of the test."""
        item.stash[BEGIN_S] = time.monotonic()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Add the figures to the report of a late test if the pauses of this computer explain them."""
        report = yield
        late = call.excinfo.value if call.excinfo else None
        if isinstance(late, Late) and self.witness and item.get_closest_marker("measures_time"):
            paused_s = self.witness.paused_s(item.stash[BEGIN_S])
            if late.took_s - paused_s <= late.limit_s:
                report.user_properties.append(
                    (PROPERTY, f"{late}; this computer stood still for {paused_s:.2f} s")
                )
        return report

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_logreport(self, report: pytest.TestReport) -> Generator[None]:
        """Turn a failure that may be excused into a skip, before any other plugin sees it."""
        figures = dict(report.user_properties).get(PROPERTY)
        if self._counts and report.failed and figures and len(self._excused) < MOST:
            self._excused.append(f"{report.nodeid}: {figures}")
            path, line, _ = report.location
            report.outcome, report.longrepr = "skipped", (path, line or 0, f"no result: {figures}")
        return (yield)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print the excused tests."""
        if self._excused:
            terminalreporter.section(f"excused, at most {MOST} in a run")
            for line in self._excused:
                terminalreporter.write_line(line)

    def pytest_sessionfinish(self) -> None:
        """End the witness."""
        if self.witness:
            self.witness.close()
