"""Benchmark of the recorder with a simulation and a virtual robot: rows of (quantity, measured, required).

`python tools/bench_record.py` prints them alone.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from bench_node import Row, Served, receive, regularity

from beatrix_zenoh import Robot
from beatrix_zenoh.client import Client
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import repair, verify
from beatrix_zenoh.settings import Settings

NAME = "bench-record"
LASTS_S = 15.0
HOUR_S = 3600.0


def turning(robots: list[Robot], seconds: float) -> None:
    """Turn the heads to and fro for a time (s)."""
    until, side = time.monotonic() + seconds, 1
    while time.monotonic() < until:
        side = -side
        for motion in [robot.look(yaw=20 * side, pitch=8 * side, wait=False) for robot in robots]:
            motion.wait()


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


def rows(endpoint: str) -> Iterator[Row]:
    """Yield all measurements of the recorder."""
    nodes = [
        Served("sim_node", "--name", NAME, "--connect", endpoint, "--ready"),
        Served("hw_node", "--name", NAME, "--connect", endpoint, "--port", "virtual:"),
    ]
    client = Client(Settings(NAME, endpoint, "ana"))
    robots = [Robot(NAME, side, client=client) for side in ("sim", "hw")]
    for robot in robots:
        robot.make_ready()
    with TemporaryDirectory() as folder:
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
    client.close()
    for node in nodes:
        node.end()


def main() -> None:
    """Print the rows."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    try:
        for figure, measured, to_reach in rows(endpoint):
            print(f"{figure:<95} {measured:<28} {to_reach}", flush=True)
    finally:
        router.end()


if __name__ == "__main__":
    main()
