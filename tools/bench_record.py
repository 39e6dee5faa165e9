"""Benchmark of the recorder with a simulation and a virtual robot: rows of (quantity, measured, required).

`python tools/bench_record.py` prints them alone. `--minutes 60` records for an hour instead, without and with pictures,
while both robots move every few seconds, and prints memory and file every ten minutes.
"""

from __future__ import annotations

import argparse
import contextlib
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir

import numpy as np
from bench_node import Row, Served, receive, regularity

from beatrix_zenoh import BeatrixError, Robot
from beatrix_zenoh.client import Client
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import repair, verify
from beatrix_zenoh.settings import Settings

NAME = "bench-record"
LASTS_S = 15.0
HOUR_S = 3600.0
EVERY_S = 600.0
"""Period of the rows of a long recording."""


def turning(robots: list[Robot], seconds: float, rest_s: float = 0.0) -> None:
    """Turn the heads to and fro for a time (s), and let them rest after each motion."""
    until, side = time.monotonic() + seconds, 1
    while time.monotonic() < until:
        side = -side
        with contextlib.suppress(BeatrixError):  # a busy computer may lose a connection; the recorder goes on
            for motion in [robot.look(yaw=20 * side, pitch=8 * side, wait=False) for robot in robots]:
                motion.wait()
        time.sleep(rest_s)


def recorded(
    endpoint: str, robots: list[Robot], path: Path, cameras: str, *, moving: bool
) -> tuple[float, float, float]:
    """Run a recorder; return its CPU (% of a core), memory (MiB) and output (MB per hour)."""
    words = ("record", str(path), "--connect", endpoint, "--cameras", cameras)
    process = Served("beatrix_zenoh.cli", *words)
    time.sleep(3.0)  # the recorder measures clocks and writes geometry and layout first
    before_s, began, length = process.cpu_s(), time.monotonic(), path.stat().st_size
    if moving:
        turning(robots, LASTS_S)
    else:
        time.sleep(LASTS_S)
    lasted = time.monotonic() - began
    cpu = (process.cpu_s() - before_s) / lasted * 100
    grown = (path.stat().st_size - length) / lasted * HOUR_S / 1e6
    rss = process.rss_mib()
    process.end()
    assert verify(path) == ""
    return cpu, rss, grown


@contextmanager
def pair(endpoint: str) -> Iterator[list[Robot]]:
    """Start a simulation and a virtual robot, ready to move."""
    nodes = [
        Served("sim_node", "--name", NAME, "--connect", endpoint, "--ready"),
        Served("hw_node", "--name", NAME, "--connect", endpoint, "--port", "virtual:"),
    ]
    try:
        with Client(Settings(NAME, endpoint, "ana")) as client:
            robots = [Robot(NAME, side, client=client) for side in ("sim", "hw")]
            for robot in robots:
                robot.make_ready()
            yield robots
    finally:
        for node in nodes:
            node.end()


def long_rows(endpoint: str, minutes: float, folder: Path) -> Iterator[Row]:
    """Yield memory and file of two recorders while they record, and their ends."""
    with pair(endpoint) as robots:
        paths = {cameras: folder / f"long-{cameras}.rrd" for cameras in ("0", "5")}
        words = ("--connect", endpoint, "--cameras")
        recorders = {
            cameras: Served("beatrix_zenoh.cli", "record", str(path), *words, cameras)
            for cameras, path in paths.items()
        }
        began = time.monotonic()
        for until_s in (60.0, *np.arange(EVERY_S, minutes * 60 + 1.0, EVERY_S).tolist()):
            turning(robots, began + until_s - time.monotonic(), rest_s=3.0)
            for cameras, process in recorders.items():
                size = paths[cameras].stat().st_size / 1e6
                yield (
                    f"record: {cameras} pictures/s, after {until_s / 60:.0f} min: RSS [MiB], file [MB]",
                    f"{process.rss_mib():.1f}, {size:.1f}",
                    "",
                )
        for cameras, process in recorders.items():
            ended_s = process.end()
            assert verify(paths[cameras]) == ""
            lost = {place[1]: samples.lost for place, samples in read(paths[cameras]).robots.items()}
            yield (
                f"record: {cameras} pictures/s: end [s], file [MB], lost positions",
                f"{ended_s:.1f}, {paths[cameras].stat().st_size / 1e6:.1f}, {lost}",
                "",
            )


def rows(endpoint: str) -> Iterator[Row]:
    """Yield all measurements of the recorder."""
    with pair(endpoint) as robots, TemporaryDirectory() as folder:
        path = Path(folder)
        for title, cameras, moving in (
            ("two robots at rest, no pictures", "0", False),
            ("two robots that move, no pictures", "0", True),
            ("two robots that move, all eyes at 5 Hz", "5", True),
        ):
            path = Path(folder) / f"{cameras}-{moving}.rrd"
            cpu, rss, grown = recorded(endpoint, robots, path, cameras, moving=moving)
            yield (
                f"record: {title}: CPU [% of a core], RSS [MiB], file [MB/h]",
                f"{cpu:.1f}, {rss:.0f}, {grown:.0f}",
                "",
            )
        began = time.perf_counter()
        assert repair(path, path.with_name("again.rrd")) == ""
        yield (
            "record: its file optimised, as by --repair: length [%], time [s]",
            (
                f"{path.with_name('again.rrd').stat().st_size / path.stat().st_size * 100:.0f}, {time.perf_counter() - began:.1f}"
            ),
            "",
        )
        began = time.perf_counter()
        count = sum(len(samples.time_ns) for samples in read(path).robots.values())
        yield f"record: {count} positions read back [s]", f"{time.perf_counter() - began:.2f}", ""
        beside = Served(
            "beatrix_zenoh.cli", "record", str(Path(folder) / "beside.rrd"), "--connect", endpoint
        )
        yield (
            "record: positions of hw meanwhile [Hz], sd of period [ms], lost",
            regularity(receive(robots[1], 10.0)),
            "50, < 1, 0",
        )
        beside.end()


def main() -> None:
    """Print the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=0.0, help="record for so long, at least 10")
    parser.add_argument(
        "--folder", type=Path, default=Path(gettempdir()), help="where long recordings are kept"
    )
    words = parser.parse_args()
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    try:
        found = long_rows(endpoint, words.minutes, words.folder) if words.minutes else rows(endpoint)
        for figure, measured, to_reach in found:
            print(f"{figure:<95} {measured:<28} {to_reach}", flush=True)
    finally:
        router.end()


if __name__ == "__main__":
    main()
