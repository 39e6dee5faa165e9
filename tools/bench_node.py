"""Figures of a node over a real router on loopback, in real processes: rows of (figure, measured, to reach)."""

from __future__ import annotations

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

from beatrix_zenoh import Refused, Robot, codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import MotionReply, PoseQuery, Positions
from beatrix_zenoh._generated.serial import MoveStraight
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.client import Client, Conversation
from beatrix_zenoh.settings import Settings
from hw_node.port import SerialPort

ROOT = Path(__file__).resolve().parent.parent
NAME = "bench"
MOVED_RAD = 0.0007
"""Half a microstep: the smallest movement that is more than noise of the settled plant."""
TICK = os.sysconf("SC_CLK_TCK")

Row = tuple[str, str, str]


class Served:
    """A process that prints `ready`."""

    def __init__(self, module: str, *arguments: str) -> None:
        began = time.monotonic()
        command = [sys.executable, "-m", module, *arguments]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT)
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line.startswith("ready"), line
        self.ready_s = time.monotonic() - began

    def cpu_s(self) -> float:
        """Processor seconds used so far."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICK

    def rss_mib(self) -> float:
        """Resident memory, MiB."""
        pages = int(Path(f"/proc/{self._process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20

    def end(self) -> float:
        """Seconds from SIGINT to the end."""
        began = time.monotonic()
        self._process.send_signal(signal.SIGINT)
        self._process.wait(10)
        return time.monotonic() - began


def spread_ms(seconds: list[float]) -> str:
    """Median / p99 / largest, ms."""
    p99 = sorted(seconds)[min(len(seconds) - 1, int(0.99 * len(seconds)))]
    return " / ".join(f"{value * 1e3:.2f}" for value in (statistics.median(seconds), p99, max(seconds)))


def accepted(robot: Robot, count: int = 500) -> list[float]:
    """Seconds from a pose query to its acceptance, 5 ms apart: what a window does."""
    key = keys.pose(NAME, robot.twin, robot.client.settings.who)
    took = []
    for number in range(count):
        query = PoseQuery(yaw=0.1 + 0.002 * (number % 2))
        began = time.perf_counter()
        with Conversation(robot.client, NAME, robot.twin, key, query) as conversation:
            reply = conversation.next(MotionReply, 2.0)
            took.append(time.perf_counter() - began)
        assert reply.result, reply.message
        time.sleep(0.005)
    robot.stop()
    return took


def paced(ask: Callable[[], object], count: int = 300) -> list[float]:
    """Seconds that each call takes, 5 ms apart."""
    took = []
    for _ in range(count):
        began = time.perf_counter()
        ask()
        took.append(time.perf_counter() - began)
        time.sleep(0.005)
    return took


def first_movement(robot: Robot, count: int = 100) -> list[float]:
    """Seconds from a query to the first published position (measured in the plant) that has moved."""
    stream = robot.stream()
    took = []
    for number in range(count):
        robot.look(yaw=3 * (number % 2))
        time.sleep(0.35)  # the plant settles
        start = (stream.take(0) + stream.take(0.1))[-1].position.x
        time.sleep(0.02 * (number * 0.618 % 1))  # on another phase of the 20 ms each time
        stream.take(0)
        began = time.perf_counter()
        motion = robot.look(yaw=3 * ((number + 1) % 2), wait=False)
        while not any(abs(new.position.x - start) > MOVED_RAD for new in stream.take(0.1)):
            pass
        took.append(time.perf_counter() - began)
        motion.wait()
    return took


def listened(robot: Robot, seconds: float) -> list[Positions]:
    """All publications of some seconds."""
    stream = robot.stream()
    got: list[Positions] = []
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        got += stream.take(0.1)
    return got


def regularity(got: list[Positions]) -> str:
    """Rate (Hz), sd of the period at the source (ms), lost publications."""
    times = [positions.t_mono_ns / 1e9 for positions in got]
    periods = [later - earlier for earlier, later in pairwise(times)]
    lost = got[-1].seq - got[0].seq + 1 - len(got)
    return f"{1 / statistics.mean(periods):.2f}, {statistics.stdev(periods) * 1e3:.2f}, {lost}"


@contextmanager
def flood(robot: Robot) -> Iterator[Callable[[], int]]:
    """Targets as fast as Zenoh takes them, unread; yields a function that gives their number a second."""
    over, sent, began = threading.Event(), [0], time.monotonic()
    key = keys.pose(NAME, robot.twin, robot.client.settings.who)
    payloads = [codec.encode(PoseQuery(yaw=yaw)) for yaw in (0.9, 1.0)]

    def run() -> None:
        asked = []
        while not over.is_set():
            asked.append(robot.client.bus.question(key, payloads[sent[0] % 2], codec.MSGPACK))
            sent[0] += 1
            if len(asked) > 500:
                asked.pop(0).close()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield lambda: int(sent[0] / (time.monotonic() - began))
    finally:
        over.set()
        thread.join()


def beside_a_flood(robot: Robot, other: Robot) -> Iterator[Row]:
    """A command and STOP of another client while targets pour in."""
    with flood(robot) as rate:
        time.sleep(1.0)
        began = time.perf_counter()
        try:
            other.calibrate()
        except Refused:
            answered = time.perf_counter() - began
        else:
            raise AssertionError("somebody else drives")
        began = time.perf_counter()
        reply = other.stop()
        stopped = time.perf_counter() - began
        beside = f"{robot.twin}: beside {rate()} targets/s: "
    yield f"{beside}a command's answer [ms]", f"{answered * 1e3:.1f}", "< 50"
    yield f"{beside}STOP, answered at rest [ms]", f"{stopped * 1e3:.0f}", "167 to decelerate from 30 deg/s"
    assert "rest at" in reply.message


def rows(twin: str, module: str, endpoint: str, *arguments: str) -> Iterator[Row]:
    """All figures of one node."""
    node = Served(module, "--name", NAME, "--connect", endpoint, *arguments)
    clients = [Client(Settings(NAME, endpoint, who)) for who in ("ana", "ben")]
    robot, other = (Robot(NAME, twin, client=client) for client in clients)
    robot.enable()
    robot.calibrate()
    time.sleep(1.0)
    before = node.cpu_s()
    got = listened(robot, 10.0)
    idle = (node.cpu_s() - before) / 10.0
    plant = robot.status().plant
    yield f"{twin}: query -> accepted [ms]", spread_ms(accepted(robot)), "< 2 / < 6"
    yield f"{twin}: query -> first published movement [ms]", spread_ms(first_movement(robot)), "< 25 / < 40"
    yield f"{twin}: positions [Hz], sd of period [ms], lost", regularity(got), "50, < 1, 0"
    yield (
        f"{twin}: idle CPU [% of a core], RSS [MiB]",
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
    yield f"{twin}: ready, clean exit [s]", f"{node.ready_s:.2f}, {node.end():.2f}", "< 2, < 1"


class Mega:
    """The shipped firmware on a simulated Mega behind a pseudo-terminal, in real time (tests/avr/live.py)."""

    def __init__(self, port: Path) -> None:
        command = [sys.executable, str(ROOT / "tests/avr/live.py"), "--path", str(port)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout is not None
        self._process.stdout.readline()

    def say(self, word: str) -> None:
        """Work it; returns when done."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(word + "\n")
        self._process.stdin.flush()
        self._process.stdout.readline()

    def end(self) -> str:
        """What it says of how it kept time."""
        out, _ = self._process.communicate("quit\n", timeout=10)
        return out.strip().rpartition("\n")[2]


def round_trips(port: Path) -> list[float]:
    """Seconds from a request's writing to its answer, without any node: wire, firmware, pyserial."""
    board = Board(lambda: SerialPort(str(port)), lambda _: None, lambda: None)
    board.start()
    while not board.link.connected:
        time.sleep(0.01)
    move = MoveStraight(1, (100, 100, 100), 800)

    def ask() -> None:
        with suppress(Refused):
            board.move(move)

    took = paced(ask)
    board.close()
    return took


def lost_s(mega: Mega, robot: Robot, word: str) -> float:
    """From a board's loss in mid-move to a status that says so, seconds."""
    robot.enable()
    robot.calibrate()
    robot.look(yaw=30, wait=False)
    time.sleep(0.3)
    began = time.perf_counter()
    mega.say(word)
    while (status := robot.status()).board.connected and status.calibrated:
        time.sleep(0.005)
    return time.perf_counter() - began


def on_a_board(endpoint: str) -> Iterator[Row]:
    """A motion's way through a node and the Mega's own firmware, simulated cycle by cycle, at the wire's real speed."""
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
            # Zenoh and threads, no check: what the machine itself takes just now.
            yield (
                "the same minutes: a question's answer, no board [ms]",
                spread_ms(paced(robot.positions)),
                "",
            )
            yield "Mega at 250 000 baud: query -> accepted [ms]", spread_ms(accepted(robot)), "< 3 / < 6"
            for word, cure in (("reset", ""), ("freeze", "go"), ("unplug", "plug")):
                yield (
                    f"Mega: {word} in mid-move -> status says so [s]",
                    f"{lost_s(mega, robot, word):.2f}",
                    "< 0.5",
                )
                if cure:
                    mega.say(cure)
                while not robot.status().board.connected:
                    time.sleep(0.05)
                robot.disable()
        node.end()
        yield "the same: " + (told := mega.end()).partition(":")[0], told.partition(":")[2].strip(), ""
