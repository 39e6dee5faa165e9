"""`make bench`: the figures of the design, measured on this computer; prints, judges nothing."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from pathlib import Path

from bench_node import ROOT, Row, Served, on_a_board, rows, spread_ms
from rich.console import Console
from rich.table import Table

from beatrix_zenoh import settings

FLOOR = "0.04 where the others were set"
"""Latencies over Zenoh are some thirty changes of threads each: a machine with twice this floor takes twice as long."""
ECHO = """
import socket
server = socket.create_server(("127.0.0.1", 0))
print(server.getsockname()[1], flush=True)
link, _ = server.accept()
link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
while data := link.recv(4096):
    link.sendall(data)
"""


def raw_tcp(count: int = 500) -> list[float]:
    """Round trips of 82 bytes between two Python processes, 5 ms apart: the floor, measured in the same run."""
    server = subprocess.Popen([sys.executable, "-c", ECHO], stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    took = []
    with socket.create_connection(("127.0.0.1", int(server.stdout.readline()))) as link:
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for _ in range(count):
            began = time.perf_counter()
            link.sendall(bytes(82))
            link.recv(4096)
            took.append(time.perf_counter() - began)
            time.sleep(0.005)
    server.wait(5)
    return took


def given_away() -> tuple[int, int]:
    """What the host gave to other computers on it, and all time, of all processors since the start (proc_stat(5))."""
    times = [
        int(word) for word in Path("/proc/stat").read_text(encoding="ascii").splitlines()[0].split()[1:9]
    ]
    return times[7], sum(times)


def share_given_away(before: tuple[int, int]) -> float:
    """Part of the processors' time since `before` that was not ours."""
    given, everything = given_away()
    return (given - before[0]) / (everything - before[1])


def show(console: Console, figures: list[Row]) -> None:
    """One table; latencies are median / p99 / largest."""
    table = Table("figure", "measured", "to reach", title="Over Zenoh: loopback, real processes")
    for row in figures:
        table.add_row(*(text.replace("[", "\\[") for text in row))
    console.print(table)


def main() -> None:
    """Nodes first, then kinematics, plant and firmware."""
    console = Console(width=130)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    assert endpoint != settings.DEFAULT_ENDPOINT, "never measure somebody's classroom"
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    began = given_away()
    try:
        figures = [("floor: raw TCP round trip in Python [ms]", spread_ms(raw_tcp()), FLOOR)]
        figures += rows("sim", "sim_node", endpoint)
        figures += rows("hw", "hw_node", endpoint, "--port", "virtual:")
        figures += on_a_board(endpoint)
    finally:
        router.end()
    given = f"{share_given_away(began):.1%}"
    figures.insert(1, ("processors' time that the host gave to others meanwhile", given, "0"))
    show(console, figures)
    for script in ("bench_kinematics.py", "bench_plant.py", "bench_poses.py", "bench_mega.py"):
        console.print(f"\n{script}")
        subprocess.run([sys.executable, str(ROOT / "tools" / script)], check=True)


if __name__ == "__main__":
    main()
