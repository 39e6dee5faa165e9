"""Benchmark of a node over a real router on loopback, in real processes: rows of (quantity, measured, required)."""

from __future__ import annotations

import json
import os
import signal
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import zenoh

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import MotionReply, PoseQuery, Positions
from beatrix_zenoh.contract._generated.serial import MoveStraight
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.settings import Settings
from hw_node.port import SerialPort

ROOT = Path(__file__).resolve().parent.parent
NAME = "bench"
MOVED_RAD = 0.0007
"""Half a microstep (rad): the smallest movement above the noise of the plant at rest."""
TICK = os.sysconf("SC_CLK_TCK")

Row = tuple[str, str, str]


class Served:
    """A process that prints `ready`."""

    def __init__(self, module: str, *words: str, account: Path | None = None, folder: Path = ROOT) -> None:
        """Start the process; `account`: file of an account of a class; `folder`: checkout whose code it runs."""
        began = time.monotonic()
        command = [sys.executable, "-m", module, *words]
        env = {**os.environ, "BEATRIX_ACCOUNT": str(account or "")}
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder, env=env)
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line.startswith("ready"), line
        self.ready_s = time.monotonic() - began

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def cpu_s(self) -> float:
        """Return the processor time used so far (s)."""
        return cpu_s(self._process.pid)

    def rss_mib(self) -> float:
        """Return the resident memory (MiB)."""
        pages = int(Path(f"/proc/{self._process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20

    def end(self) -> float:
        """Send SIGINT and wait for the end of the process; return the time until then (s)."""
        began = time.monotonic()
        self._process.send_signal(signal.SIGINT)
        self._process.wait(10)
        return time.monotonic() - began


def cpu_s(pid: int) -> float:
    """Return the processor time that a process has used so far (s)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def free_endpoint() -> str:
    """Return an endpoint for a new router, on a free port of this computer."""
    return f"tcp/127.0.0.1:{free_port()}"


def spread_ms(seconds: list[float]) -> str:
    """Format times (s) as median / p99 / largest, in ms."""
    p99 = sorted(seconds)[min(len(seconds) - 1, int(0.99 * len(seconds)))]
    return " / ".join(f"{value * 1e3:.2f}" for value in (statistics.median(seconds), p99, max(seconds)))


BARE = """
import json, sys, zenoh
from zenoh.handlers import Callback
config = zenoh.Config()
for key, value in json.loads(sys.argv[1]).items():
    config.insert_json5(key, json.dumps(value))
def answer(query):
    query.reply("bench/echo", query.payload.to_bytes())
    query.drop()
with zenoh.open(config) as session:
    queryable = session.declare_queryable("bench/echo", Callback(answer, indirect=False))
    print("ready", flush=True)
    sys.stdin.read()
"""
"""Program of a queryable that only replies, so that a query measures the latency of Zenoh and the router alone."""


class Bare:
    """A bare Zenoh query over a router, from this process to another one, with Zenoh's own client sessions."""

    def __init__(self, endpoint: str) -> None:
        settings = {
            "mode": "client",
            "connect/endpoints": [endpoint],
            "scouting/multicast/enabled": False,
            "transport/shared_memory/enabled": False,
        }
        command = [sys.executable, "-c", BARE, json.dumps(settings)]
        self._server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._server.stdout is not None
        self._server.stdout.readline()
        config = zenoh.Config()
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        self._session = zenoh.open(config)

    def query(self) -> None:
        """Send a query of 82 bytes and read its reply of the same length."""
        replies = self._session.get("bench/echo", payload=bytes(82), timeout=2.0)
        for reply in replies:
            assert reply.ok is not None
            reply.ok.payload.to_bytes()

    def close(self) -> None:
        """Close the session of this process, and end the other process."""
        self._session.close()
        self._server.communicate("", timeout=10)


def against_bare(robot: Robot, endpoint: str) -> tuple[list[float], list[float]]:
    """Return the times (s) from queries to their acceptance, and those of bare Zenoh queries, sent alternately."""
    bare, took = Bare(endpoint), []

    def ask() -> None:
        began = time.perf_counter()
        bare.query()
        took.append(time.perf_counter() - began)
        time.sleep(0.005)

    ours = accepted(robot, between=ask)
    bare.close()
    return ours, took


def accepted(robot: Robot, count: int = 500, between: Callable[[], None] = lambda: None) -> list[float]:
    """Return the times (s) from pose queries, like those of the window and 5 ms apart, to their acceptance."""
    key = keys.pose(NAME, robot.side, robot.client.settings.who)
    took = []
    for number in range(count):
        between()
        query = PoseQuery(yaw=0.1 + 0.002 * (number % 2))
        began = time.perf_counter()
        request = Request(robot.client, robot.place, key, query, 30.0)
        reply = request.next(MotionReply, 2.0)
        took.append(time.perf_counter() - began)
        request.close()
        assert reply.result, reply.message
        time.sleep(0.005)
    robot.stop()
    return took


def paced(ask: Callable[[], object], count: int = 300) -> list[float]:
    """Return the times (s) of `count` calls, 5 ms apart."""
    took = []
    for _ in range(count):
        began = time.perf_counter()
        ask()
        took.append(time.perf_counter() - began)
        time.sleep(0.005)
    return took


def first_movement(robot: Robot, count: int = 100) -> list[float]:
    """Return the times (s) from a query to the first published position that has changed."""
    stream = robot.positions_stream()
    took = []
    for number in range(count):
        robot.look(yaw=3 * (number % 2))
        time.sleep(0.35)  # the plant comes to rest
        start = (stream.take(0) + stream.take(0.1))[-1].position.x
        time.sleep(0.02 * (number * 0.618 % 1))  # vary the phase within the period of 20 ms
        stream.take(0)
        began = time.perf_counter()
        motion = robot.look(yaw=3 * ((number + 1) % 2), wait=False)
        while not any(abs(new.position.x - start) > MOVED_RAD for new in stream.take(0.1)):
            pass
        took.append(time.perf_counter() - began)
        motion.wait()
    return took


def receive(robot: Robot, seconds: float) -> list[Positions]:
    """Return all positions that arrive within a time (s)."""
    stream = robot.positions_stream()
    got: list[Positions] = []
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        got += stream.take(0.1)
    return got


def regularity(got: list[Positions]) -> str:
    """Format rate (Hz), standard deviation of the period at the source (ms), and number of lost publications."""
    times = [positions.t_mono_ns / 1e9 for positions in got]
    periods = [later - earlier for earlier, later in pairwise(times)]
    lost = got[-1].seq - got[0].seq + 1 - len(got)
    return f"{1 / statistics.mean(periods):.2f}, {statistics.stdev(periods) * 1e3:.2f}, {lost}"


@contextmanager
def flood(robot: Robot) -> Iterator[Callable[[], int]]:
    """Send targets as fast as Zenoh accepts them; yield a function that returns their rate (Hz)."""
    over, sent, began = threading.Event(), [0], time.monotonic()
    key = keys.pose(NAME, robot.side, robot.client.settings.who)
    payloads = [codec.encode(PoseQuery(yaw=yaw)) for yaw in (0.9, 1.0)]

    def run() -> None:
        requests = []
        while not over.is_set():
            requests.append(robot.client.bus.query(key, payloads[sent[0] % 2], codec.MSGPACK))
            sent[0] += 1
            if len(requests) > 500:
                requests.pop(0).close()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield lambda: int(sent[0] / (time.monotonic() - began))
    finally:
        over.set()
        thread.join()


def beside_a_flood(robot: Robot, other: Robot) -> Iterator[Row]:
    """Yield the latencies of a command and of a STOP of another client during a flood of targets."""
    with flood(robot) as rate:
        time.sleep(1.0)
        began = time.perf_counter()
        try:
            other.calibrate()
        except Refused:
            answered = time.perf_counter() - began
        else:
            raise AssertionError("the command must be refused: another client drives")
        began = time.perf_counter()
        reply = other.stop()
        stopped = time.perf_counter() - began
        beside = f"{robot.side}: beside {rate()} targets/s: "
    yield f"{beside}a command's answer [ms]", f"{answered * 1e3:.1f}", "< 50"
    yield f"{beside}STOP, answered at rest [ms]", f"{stopped * 1e3:.0f}", "167 to decelerate from 30°/s"
    assert "rest at" in reply.message


def rows(side: str, module: str, endpoint: str, *arguments: str) -> Iterator[Row]:
    """Yield all measurements of one node."""
    node = Served(module, "--name", NAME, "--connect", endpoint, *arguments)
    clients = [Client(Settings(NAME, endpoint, who)) for who in ("ana", "ben")]
    robot, other = (Robot(NAME, side, client=client) for client in clients)
    robot.enable()
    robot.calibrate()
    time.sleep(1.0)
    before = node.cpu_s()
    got = receive(robot, 10.0)
    idle = (node.cpu_s() - before) / 10.0
    plant = robot.status().plant
    ours, bare = against_bare(robot, endpoint)
    ratio = statistics.median(ours) / statistics.median(bare)
    yield f"{side}: query -> accepted [ms]", spread_ms(ours), "p99 < 6"
    yield "the same run: a bare Zenoh query [ms]", spread_ms(bare), ""
    yield f"{side}: ratio of the medians", f"{ratio:.2f}", "<= 2.0"
    yield f"{side}: query -> first published movement [ms]", spread_ms(first_movement(robot)), "< 25 / < 40"
    yield f"{side}: positions [Hz], sd of period [ms], lost", regularity(got), "50, < 1, 0"
    yield (
        f"{side}: idle CPU [% of a core], RSS [MiB]",
        f"{idle * 100:.1f}, {node.rss_mib():.0f}",
        "<= 10, < 200",
    )
    if plant is not None:
        yield (
            "sim: real-time factor, late steps",
            f"{plant.real_time_factor:.4f}, {plant.late_steps}",
            "1.000 +- 0.005",
        )
    yield from beside_a_flood(robot, other)
    for client in clients:
        client.close()
    yield f"{side}: ready, clean exit [s]", f"{node.ready_s:.2f}, {node.end():.2f}", "< 2, < 1"


class Mega:
    """The shipped firmware on a simulated Mega behind a pseudo-terminal, in real time (tests/avr/live.py)."""

    def __init__(self, port: Path) -> None:
        command = [sys.executable, str(ROOT / "tests/avr/live.py"), "--path", str(port)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout is not None
        self._process.stdout.readline()

    def reset(self) -> None:
        """Press the reset button."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write("reset\n")
        self._process.stdin.flush()
        self._process.stdout.readline()

    def freeze(self) -> None:
        """Suspend the board, which then answers nothing."""
        self._process.send_signal(signal.SIGSTOP)

    def resume(self) -> None:
        """Let a frozen board go on."""
        self._process.send_signal(signal.SIGCONT)

    def end(self) -> None:
        """End the simulation."""
        self._process.communicate(timeout=10)


def round_trips(port: Path) -> list[float]:
    """Return the times (s) from a request to its answer without a node: serial line, firmware, pyserial."""
    board = Board(lambda: SerialPort(str(port)), lambda _: None, lambda: None)
    board.start()
    while not board.connected:
        time.sleep(0.01)
    move = MoveStraight(1, (100, 100, 100), 800)

    def ask() -> None:
        with suppress(Refused):
            board.move(move)

    took = paced(ask)
    board.close()
    return took


def lost_s(robot: Robot, lose: Callable[[], None]) -> float:
    """Return the time (s) from a reset or loss of the board during a motion to a status that reports it.

    Raises TimeoutError after 10 s.
    """
    robot.enable()
    robot.calibrate()
    robot.look(yaw=30, wait=False)
    time.sleep(0.3)
    began = time.perf_counter()
    lose()
    while (status := robot.status()).board.connected and status.calibrated:
        if time.perf_counter() - began > 10:
            raise TimeoutError(f"The status does not report within 10 s what {lose.__name__} has done.")
        time.sleep(0.005)
    return time.perf_counter() - began


def on_a_board(endpoint: str) -> Iterator[Row]:
    """Yield latencies through a node and the Mega's firmware, simulated cycle by cycle, at the real baud rate."""
    with TemporaryDirectory() as folder:
        port = Path(folder) / "board"
        mega = Mega(port)
        yield (
            "Mega at 250 000 baud: MOVE_STRAIGHT -> its answer, no node [ms]",
            spread_ms(round_trips(port)),
            "",
        )
        node = Served("hw_node", "--name", NAME, "--connect", endpoint, "--port", str(port))
        with Client(Settings(NAME, endpoint, "ana")) as client:
            robot = Robot(NAME, "hw", client=client)
            robot.enable()
            robot.calibrate()
            # A query for positions needs Zenoh and threads, but no check and no board: it shows the present speed of
            # this computer.
            yield "the same minutes: a query's answer, no board [ms]", spread_ms(paced(robot.positions)), ""
            yield "Mega at 250 000 baud: query -> accepted [ms]", spread_ms(accepted(robot)), "< 3 / < 6"
            for lose in (mega.reset, mega.freeze):
                what = f"Mega: {lose.__name__} during a motion -> status reports it [s]"
                yield what, f"{lost_s(robot, lose):.2f}", "< 0.5"
                mega.resume()
                while not robot.status().board.connected:
                    time.sleep(0.05)
                robot.disable()
        node.end()
        mega.end()
