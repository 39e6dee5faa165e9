"""`make bench`: the figures of the design, measured on this computer, beside what they are compared with.

Every figure comes from real processes over a real router on loopback; nothing here judges.
"""

from __future__ import annotations

import math
import os
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from beatrix_zenoh import Interrupted, Refused, Robot, codec
from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import CommandQuery, MotionReply, PoseQuery, Positions
from beatrix_zenoh.client import Client, Conversation
from beatrix_zenoh.settings import Settings

ROOT = Path(__file__).resolve().parent.parent
MOVED_RAD = 0.0007
"""Half a microstep: the smallest movement that is more than noise of the settled plant."""
TICK = os.sysconf("SC_CLK_TCK")


class Served:
    """A node process that serves."""

    def __init__(self, module: str, endpoint: str, *arguments: str) -> None:
        began = time.monotonic()
        command = [sys.executable, "-m", module, "--name", "bench", "--connect", endpoint, *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT)
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line.startswith("ready"), line
        self.ready_s = time.monotonic() - began

    def cpu_s(self) -> float:
        """Processor seconds used so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICK

    def rss_mib(self) -> float:
        """Resident memory, MiB."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20

    def end_s(self) -> float:
        """Seconds from SIGINT to the end."""
        began = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        self.process.wait(10)
        return time.monotonic() - began


def percentile(values: list[float], share: float) -> float:
    """The value below which `share` of all lie."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def spread(values: list[float]) -> str:
    """Median, p99 and largest, ms."""
    return f"{statistics.median(values) * 1e3:.2f} / {percentile(values, 0.99) * 1e3:.2f} / {max(values) * 1e3:.2f}"


def raw_tcp(count: int) -> list[float]:
    """Round trips of 82 bytes over a TCP connection between two processes: the floor."""
    code = (
        "import socket; s = socket.create_server(('127.0.0.1', 0)); print(s.getsockname()[1], flush=True)\n"
        "c, _ = s.accept(); c.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)\n"
        "while d := c.recv(4096): c.sendall(d)"
    )
    server = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
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


def accepted(client: Client, twin: str, count: int) -> list[float]:
    """Seconds from a pose query to its acceptance, 5 ms apart: what a window does."""
    key = keys.pose("bench", twin, client.settings.who)
    took = []
    for number in range(count):
        query = PoseQuery(yaw=0.1 + 0.002 * (number % 2))
        began = time.perf_counter()
        with Conversation(client, "bench", twin, key, query) as conversation:
            reply = conversation.next(MotionReply, 2.0)
            took.append(time.perf_counter() - began)
        assert reply.result, reply.message
        time.sleep(0.005)
    return took


def first_movement(robot: Robot, count: int) -> list[float]:
    """Seconds from a query to the first published position, measured in the plant, that has moved."""
    stream = robot.stream()
    took = []
    for number in range(count):
        robot.look(yaw=3 if number % 2 else 0, speed=30)
        time.sleep(0.35 + 0.0007 * number)  # settle, and fall on another phase of the 20 ms each time
        stream.take(0)
        start = stream.take(0.1)[-1].position.x
        began = time.perf_counter()
        motion = robot.look(yaw=0 if number % 2 else 3, speed=30, wait=False)
        while not any(abs(new.position.x - start) > MOVED_RAD for new in stream.take(0.1)):
            pass
        took.append(time.perf_counter() - began)
        motion.wait()
    return took


def rates(robot: Robot, seconds: float) -> tuple[float, float, int]:
    """Rate (Hz), sd of the period at the source (ms), lost publications."""
    stream = robot.stream()
    got: list[Positions] = []
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        got += stream.take(0.1)
    times = [positions.t_mono_ns / 1e9 for positions in got]
    periods = [b - a for a, b in zip(times, times[1:], strict=False)]
    lost = got[-1].seq - got[0].seq + 1 - len(got)
    return (len(got) - 1) / (times[-1] - times[0]), statistics.stdev(periods) * 1e3, lost


def flooded(robot: Robot, other: Robot, act: Callable[[], object]) -> tuple[float, int]:
    """Seconds `act` took while another session sends targets as fast as it can, and how many a second."""
    over, sent = threading.Event(), [0]
    key = keys.pose("bench", robot.twin, robot.client.settings.who)
    payloads = [codec.encode(PoseQuery(yaw=yaw)) for yaw in (0.5, 0.6)]

    def run() -> None:
        open_questions = []
        while not over.is_set():
            open_questions.append(robot.client.bus.question(key, payloads[sent[0] % 2], codec.MSGPACK))
            sent[0] += 1
            if len(open_questions) > 500:
                open_questions.pop(0).close()

    thread = threading.Thread(target=run)
    began = time.monotonic()
    thread.start()
    time.sleep(1.0)
    act_began = time.perf_counter()
    act()
    took = time.perf_counter() - act_began
    rate = sent[0] / (time.monotonic() - began)
    over.set()
    thread.join()
    other.stop()
    return took, int(rate)


def command_latency(robot: Robot) -> None:
    """One command that needs an answer of the driver; refused is an answer too."""
    query = CommandQuery(command=99)
    key = keys.command("bench", robot.twin, robot.client.settings.who)
    robot.client.ask("bench", robot.twin, key, query, codec_reply(), 10.0)


def codec_reply() -> type:
    """CommandReply, imported where it is used."""
    from beatrix_zenoh._generated.messages import CommandReply  # noqa: PLC0415

    return CommandReply


def bench_twin(table: Table, twin: str, module: str, endpoint: str, *arguments: str) -> None:
    """All figures of one node."""
    node = Served(module, endpoint, *arguments)
    client, other_client = Client(Settings("bench", endpoint, "ana")), Client(Settings("bench", endpoint, "ben"))
    robot, other = Robot("bench", twin, client=client), Robot("bench", twin, client=other_client)
    robot.enable()
    robot.calibrate()
    time.sleep(1.0)
    idle = node.cpu_s()
    rate, sd_ms, lost = rates(robot, 10.0)
    idle_share = (node.cpu_s() - idle) / 10.0
    factor = robot.status().plant
    table.add_row(f"{twin}: ready, clean exit [s]", "", "< 2; < 1")
    row = table.row_count - 1
    table.add_row(f"{twin}: query -> accepted, median / p99 / max [ms]", spread(accepted(client, twin, 500)), "< 2 / < 6")
    robot.stop()
    table.add_row(f"{twin}: query -> first published movement [ms]", spread(first_movement(robot, 100)), "< 25 / < 40")
    table.add_row(f"{twin}: positions: rate [Hz], sd of period [ms], lost", f"{rate:.2f}, {sd_ms:.2f}, {lost}", "50, < 1, 0")
    table.add_row(f"{twin}: idle CPU [% of a core], RSS [MiB]", f"{idle_share * 100:.1f}, {node.rss_mib():.0f}", "<= 10, < 200")
    if factor is not None:
        table.add_row("sim: real-time factor, late steps", f"{factor.real_time_factor:.4f}, {factor.late_steps}", "1.000 +- 0.005")
    took, per_s = flooded(robot, other, other.stop)
    table.add_row(f"{twin}: STOP until at rest, beside {per_s} targets/s [ms]", f"{took * 1e3:.0f}", "170 to decelerate from 30 deg/s")
    took, per_s = flooded(robot, other, lambda: command_latency(other))
    table.add_row(f"{twin}: a command's answer beside {per_s} targets/s [ms]", f"{took * 1e3:.1f}", "< 50")
    client.close()
    other_client.close()
    end_s = node.end_s()
    table.columns[1]._cells[row] = f"{node.ready_s:.2f}, {end_s:.2f}"  # noqa: SLF001  # known only now


def main() -> None:
    """Print all tables."""
    console = Console(width=140)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    router = subprocess.Popen(
        [sys.executable, "-m", "beatrix_zenoh.cli", "router", "--listen", endpoint], stdout=subprocess.PIPE, text=True
    )
    assert router.stdout is not None
    assert router.stdout.readline().startswith("ready")
    table = Table("figure", "measured", "to reach", title="BEATRIX over Zenoh, loopback, real processes")
    table.add_row("floor: raw TCP round trip in Python, median / p99 / max [ms]", spread(raw_tcp(500)), "")
    try:
        bench_twin(table, "sim", "sim_node", endpoint)
        bench_twin(table, "hw", "hw_node", endpoint, "--port", "virtual:")
    finally:
        router.send_signal(signal.SIGINT)
        router.wait(5)
    console.print(table)
    for script in ("bench_kinematics.py", "bench_plant.py"):
        console.print(f"\n[bold]{script}[/bold]")
        subprocess.run([sys.executable, str(ROOT / "tools" / script)], check=True)


if __name__ == "__main__":
    main()
