"""The live output with real viewers that start, hang and end; the output never waits for them."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from robots import until

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.recording.outputs import PERIOD_S, PROBE_S, LiveOutput
from beatrix_zenoh.recording.rows import Frame, Numbers, RecordingRow, RobotSet, of_robot
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import Viewer

SIM = ("bea", "sim")
ROBOTS = RobotSet({SIM: Figure()})
PICTURE = os.urandom(50_000)


class Feed:
    """An output with rows like those of the recorder, and a clock that each call of `feed` advances."""

    def __init__(self, port: int) -> None:
        self.messages: list[str] = []
        self.output = LiveOutput(port, self.messages.append)
        self.now_s = 1000.0
        self.count = 0

    def feed(self) -> bool:
        """Write the rows of one period; return whether the output has restarted."""
        stamp = 1_763_000_000_000_000_000 + self.count * 20_000_000
        self.count += 1
        rows: list[RecordingRow] = [
            Numbers(of_robot(SIM, what), stamp, (1.0, 2.0, 3.0)) for what in ("arms", "commanded", "head")
        ]
        rows += [Frame(of_robot(SIM, "camera", "left"), stamp, PICTURE)] * 4
        self.output.write(rows)
        self.now_s += PROBE_S + PERIOD_S
        restarted = self.output.update(self.now_s)
        if restarted:
            self.output.show(ROBOTS)
        return restarted

    def until(self, *, connected: bool) -> int:
        """Feed until the viewer receives data, or does not; return how often the output has restarted."""
        begun = 0

        def fed() -> bool:
            nonlocal begun
            begun += self.feed()
            return self.output.connected is connected

        until(fed, f"the viewer receives data: {connected}")
        return begun


@contextmanager
def server(port: int, *words: str) -> Iterator[Viewer]:
    """A viewer's server, without its window."""
    with Viewer(port, "--serve-grpc", *words) as viewer:
        viewer.wait_ready()
        yield viewer


def resident_mb() -> float:
    """Return the memory of this process (MB)."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def test_a_missing_viewer_is_reported_once() -> None:
    feed = Feed(free_port())
    for _ in range(5):
        assert not feed.feed()
    assert feed.output.connected is False
    assert len(feed.messages) == 1
    assert "No viewer on 127.0.0.1" in feed.messages[0]
    assert "beatrix view --port" in feed.messages[0]
    assert feed.output.left_out == 5 * 7
    assert feed.output.close()


def test_a_viewer_that_starts_later_gets_all_later_rows(tmp_path: Path) -> None:
    port, kept = free_port(), tmp_path / "kept.rrd"
    feed = Feed(port)
    feed.feed()
    with Viewer(port, "--save", str(kept)) as viewer:
        viewer.wait_ready()
        assert feed.until(connected=True) == 1
        for _ in range(10):
            assert not feed.feed()
        assert feed.output.close()
        until(lambda: samples_in(kept) == 10, "the server has written all of it")
    assert len(feed.messages) == 2
    assert "missed" in feed.messages[1]


def samples_in(path: Path) -> int:
    """Return the number of positions in a file that is being written; 0 if it cannot be read yet."""
    try:
        return len(read(path).robots[SIM].time_ns)
    except Refused:
        return 0


@pytest.mark.long("a real viewer")
def test_a_suspended_viewer_needs_no_memory_of_the_recorder_and_gets_rows_again() -> None:
    with server(port := free_port()) as viewer:
        feed = Feed(port)
        feed.until(connected=True)
        os.kill(viewer.pid, signal.SIGSTOP)
        feed.until(connected=False)
        before = resident_mb()
        for _ in range(100):  # 20 MB of pictures
            feed.output.write([Frame("bea/sim/camera/left", 0, PICTURE)] * 4)
        feed.feed()
        assert resident_mb() - before < 8
        assert feed.output.left_out > 400
        os.kill(viewer.pid, signal.SIGCONT)
        assert feed.until(connected=True) == 1
        assert len(feed.messages) == 2
        assert feed.output.close()
