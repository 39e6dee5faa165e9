"""`make bench`: measure the performance on this computer and print it."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import bench_media
import bench_record
from bench_node import ROOT, Row, Served, free_endpoint, on_a_board, rows, spread_ms
from rich.console import Console
from rich.table import Table

FLOOR = "0.04 on the reference computer"
"""Shown instead of a requirement. A latency over Zenoh contains about thirty thread switches: if the floor is twice as
high, the latency is, too."""
OTHERS = (
    "bench_eyes.py",
    "bench_ears.py",
    "bench_kinematics.py",
    "bench_plant.py",
    "bench_poses.py",
    "bench_mega.py",
    "bench_following.py",
    "bench_twin.py",
    "bench_window.py",
    "bench_head3d.py",
    "bench_classroom.py",
    "bench_many.py 30",
    "bench_pages.py 0 30",
    "bench_pages.py class",
)
"""Benchmarks that are programs of their own, with their arguments."""
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
    """Return the times of round trips of 82 bytes between two Python processes (s), 5 ms apart."""
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


def stolen_time() -> tuple[int, int]:
    """Return the processor time that the host gave to other virtual machines, and the total time.

    Both are in clock ticks since the start of the computer (proc_stat(5)).
    """
    times = [
        int(word) for word in Path("/proc/stat").read_text(encoding="ascii").splitlines()[0].split()[1:9]
    ]
    return times[7], sum(times)


def stolen_share(before: tuple[int, int]) -> float:
    """Return the share of the processor time since `before` that the host gave to other virtual machines."""
    stolen, total = stolen_time()
    return (stolen - before[0]) / (total - before[1])


def show(console: Console, figures: list[Row]) -> None:
    """Print a table; latencies are median / p99 / largest."""
    table = Table("quantity", "measured", "required", title="Over Zenoh: loopback, real processes")
    for row in figures:
        table.add_row(*(text.replace("[", "\\[") for text in row))
    console.print(table)


def nodes(endpoint: str) -> Iterator[Row]:
    """Measure the nodes of a simulation and of a virtual board."""
    yield "floor: raw TCP round trip in Python [ms]", spread_ms(raw_tcp()), FLOOR
    yield from rows("sim", "sim_node", endpoint)
    yield from rows("hw", "hw_node", endpoint, "--port", "virtual:")


PARTS: dict[str, Callable[[str], Iterable[Row]]] = {
    "nodes": nodes,
    "board": on_a_board,
    "cameras": bench_media.rows,
    "recorder": bench_record.rows,
}
"""What is measured over Zenoh, by name, at a router's endpoint."""


def over_zenoh(*parts: str) -> list[Row]:
    """Measure these parts at a router of their own."""
    endpoint = free_endpoint()
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    began = stolen_time()
    try:
        figures = [row for part in parts for row in PARTS[part](endpoint)]
    finally:
        router.end()
    stolen = f"{stolen_share(began):.1%}"
    return [("processor time that the host gave to other virtual machines", stolen, "0"), *figures]


def main() -> None:
    """Measure over Zenoh, then run the other benchmarks."""
    console = Console(width=130)
    show(console, over_zenoh(*PARTS))
    for script in OTHERS:
        console.print(f"\n{script}")
        program, *words = script.split()
        subprocess.run([sys.executable, str(ROOT / "tools" / program), *words], check=True)


if __name__ == "__main__":
    main()
