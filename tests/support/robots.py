"""A stage for node tests: a router, and robots as real processes that are connected to it."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Self

import pytest

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Reply, Sessions
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Positions, Reason, Status
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.node import Node
from beatrix_zenoh.node.node import RobotBody
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.settings import Settings
from hw_node.body import VirtualHardware

START_S = 60.0
"""Time limit (s) of a start: a busy machine may need this long to import MuJoCo."""
END_S = 30.0
PATIENCE_S = 10.0
"""Time limit (s) of an answer on a busy machine."""
EVENT_S = 20.0
"""Time limit (s) of an event whose delay no test checks."""
ROOT = Path(__file__).resolve().parents[2]


def untraced() -> dict[str, str]:
    """Return the environment of a process whose coverage is not counted.

    Counting doubles the processor time of a robot; and a KeyboardInterrupt inside coverage's tracer keeps the
    tracer's lock forever.
    """
    return {name: value for name, value in os.environ.items() if name != "COVERAGE_PROCESS_CONFIG"}


def python(folder: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run Python in a folder to its end, as a user does: without the PYTHONPATH of the tests."""
    kept = {name: value for name, value in untraced().items() if name != "PYTHONPATH"}
    return subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        env={**kept, **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def free_endpoint() -> str:
    """Return a loopback endpoint on which no process listens."""
    return f"tcp/127.0.0.1:{free_port()}"


def until(holds: Callable[[], bool], what: str, timeout_s: float = EVENT_S) -> None:
    """Poll a condition that causes no event; raise AssertionError if it does not hold within the time limit."""
    deadline = time.monotonic() + timeout_s
    pause = threading.Event()
    while not holds():
        assert time.monotonic() < deadline, f"not within {timeout_s} s: {what}"
        pause.wait(0.01)


def _suspended(thread: Path) -> bool:
    """Return whether a thread of a process, such as /proc/7/task/8, is suspended or has ended."""
    with contextlib.suppress(OSError):
        return (thread / "stat").read_text().rpartition(")")[2].split()[0] in "TtZX"
    return True


def children(pid: int) -> dict[int, str]:
    """Return the command lines of a process's living children by process number; none if /proc is missing."""
    found = {}
    for listing in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):  # that thread has just ended
            for number in map(int, listing.read_text().split()):
                with contextlib.suppress(OSError):  # that child has just ended
                    state = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0]
                    command = Path(f"/proc/{number}/cmdline").read_bytes().replace(b"\0", b" ")
                    if state != "Z":
                        found[number] = command.decode(errors="replace").strip()
    return found


class Process:
    """A child process whose output lines are read as they arrive."""

    def __init__(
        self,
        *command: str,
        listens: bool = False,
        traced: bool = True,
        folder: Path = ROOT,
        inside: tuple[str, ...] = (),
    ) -> None:
        """Start Python; `inside` is a command that starts it elsewhere, such as in a network namespace."""
        self._child = subprocess.Popen(
            [*inside, sys.executable, *command],
            stdin=subprocess.PIPE if listens else None,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=folder,
            env=dict(os.environ if traced else untraced(), PYTHONUNBUFFERED="1"),
        )
        self.pid = self._child.pid
        self.lines: list[str] = []
        self._queue: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._child.stdout is not None
        for line in self._child.stdout:
            self._queue.put(line.rstrip("\n"))
        self._queue.put(None)

    def expect(self, beginning: str | tuple[str, ...], timeout_s: float = START_S) -> str:
        """Return the next line with this beginning, or with one of several."""
        deadline = time.monotonic() + timeout_s
        while True:
            try:
                line = self._queue.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"no {beginning!r} within {timeout_s} s; output: {self.lines}") from None
            assert line is not None, f"ended without {beginning!r}; output: {self.lines}"
            self.lines.append(line)
            if line.startswith(beginning):
                return line

    def expect_all(self, *beginnings: str) -> None:
        """Wait for lines with these beginnings, in any order."""
        missing = set(beginnings)
        while missing:
            line = self.expect(tuple(missing))
            missing -= {beginning for beginning in missing if line.startswith(beginning)}

    def say(self, line: str) -> None:
        """Write a line to the standard input of the process."""
        assert self._child.stdin is not None, "started with listens=True"
        self._child.stdin.write(line + "\n")
        self._child.stdin.flush()

    def name_thread(self, name: str) -> None:
        """Give the thread that reads the output another name."""
        self._reader.name = name

    def send(self, number: signal.Signals) -> None:
        """Send a signal; with SIGSTOP wait until each thread of the process is suspended."""
        self._child.send_signal(number)
        if number is signal.SIGSTOP:
            until(lambda: all(map(_suspended, Path(f"/proc/{self._child.pid}/task").iterdir())), "suspended")

    def wait(self, timeout_s: float = END_S) -> int:
        """Wait for the end of the process; return its exit code."""
        code = self._child.wait(timeout=timeout_s)
        self._reader.join(timeout=5)
        while not self._queue.empty():
            line = self._queue.get()
            if line is not None:
                self.lines.append(line)
        for pipe in (self._child.stdin, self._child.stdout):
            if pipe is not None:
                pipe.close()
        return code

    def end(self, number: signal.Signals = signal.SIGTERM) -> int:
        """End the process if it still runs; return its exit code."""
        if self._child.poll() is None:
            self._child.send_signal(signal.SIGCONT)
            self._child.send_signal(number)
        try:
            return self.wait()
        except subprocess.TimeoutExpired:
            self._child.kill()
            self.wait()
            raise


@contextlib.contextmanager
def routing(endpoint: str) -> Iterator[Process]:
    """Run a router in a process of its own, as in a class: a crash of the router does not end the tests."""
    router = start_router(endpoint)
    try:
        yield router
    finally:
        router.end()


def start_router(endpoint: str) -> Process:
    """Start the process of a router; return when it is ready. The caller ends it."""
    # With --with-parent it ends with its parent, even if that is killed.
    router = Process(
        "-m", "beatrix_zenoh.cli", "--with-parent", "router", "--listen", endpoint, listens=True, traced=False
    )
    router.expect("ready")
    return router


IDLE: dict[str, Process] = {}
"""Routers by endpoint that no stage uses: the start of a process takes longer than many tests. They end with the tests."""
IDLE_THREAD = "output of an idle router"


def end_idle_routers() -> None:
    """End the routers that no stage uses."""
    while IDLE:
        IDLE.popitem()[1].end()


class Stage:
    """A router and robots in processes of their own, clients here; all ended on exit, but the router waits for the next.

    `traced`: count the coverage of its simulations and hardware nodes.
    """

    def __init__(self, *, traced: bool = False) -> None:
        self._traced = traced
        self._own_router = False
        if IDLE:
            self.endpoint, self._router = IDLE.popitem()
        else:
            self.endpoint = free_endpoint()
            self._router = start_router(self.endpoint)
            self._router.name_thread(IDLE_THREAD)
        self._processes: list[Process] = []
        self._nodes: list[Node] = []
        self._clients: list[Client] = []

    def process(self, module: str, *arguments: str) -> Process:
        """Start a process that is ended with the stage."""
        return self._started(Process("-m", module, *arguments))

    def script(self, path: Path, *arguments: str, listens: bool = False) -> Process:
        """Start a Python program that is ended with the stage."""
        return self._started(Process(str(path), *arguments, listens=listens, traced=False))

    def _started(self, process: Process) -> Process:
        self._processes.append(process)
        return process

    def simulation(self, name: str, *arguments: str) -> Process:
        """Start a simulation; return when it serves."""
        return self._robot("sim_node", name, *arguments)

    def hardware(self, name: str, port: str = "virtual:", *arguments: str) -> Process:
        """Start a hardware node; return when it serves."""
        return self._robot("hw_node", name, "--port", port, *arguments)

    def _robot(self, module: str, name: str, *arguments: str) -> Process:
        where = ("--name", name, "--connect", self.endpoint)
        process = self._started(Process("-m", module, *where, *arguments, traced=self._traced))
        process.expect("ready")
        return process

    def mega(self, path: Path, *options: str) -> Process:
        """Start a simulated Mega with a port at `path`; options and commands are those of tests/avr/live.py."""
        process = self._started(
            Process("tests/avr/live.py", "--path", str(path), *options, listens=True, traced=False)
        )
        process.expect("ready")
        return process

    def recorder(self, path: Path, *options: str) -> Process:
        """Start `beatrix record`; return when it is ready."""
        words = ("record", str(path), "--connect", self.endpoint, *options)
        process = self.process("beatrix_zenoh.cli", *words)
        process.expect("ready")
        return process

    def node(
        self,
        name: str,
        body: RobotBody | None = None,
        robot: RobotData = ROBOT,
        terminal: Terminal | None = None,
        kept: Path | None = None,
    ) -> Node:
        """Start a node inside this process, on a virtual board of its own unless a body is given."""
        body = body or VirtualHardware(name)
        sessions = Sessions(lambda: zbus.connect(self.endpoint))
        node = Node(sessions, name, body, robot, terminal, kept).start()
        self._nodes.append(node)
        return node

    def client(self, who: str = "ana") -> Client:
        """Open the session of a client."""
        client = Client(Settings("bea", self.endpoint, who))
        self._clients.append(client)
        return client

    def robot(self, name: str, side: str, who: str = "ana") -> Robot:
        """Return a robot with a session of its own."""
        return Robot(name, side, client=self.client(who), timeout_s=PATIENCE_S)

    def close_clients(self) -> None:
        """End the sessions of all clients; robots and router go on."""
        while self._clients:
            self._clients.pop().close()

    def close(self) -> None:
        """End the clients, then robots and boards, and the router last."""
        self.close_clients()
        self.end_nodes()
        for process in reversed(self._processes):
            process.end()
        if self._own_router:
            self._router.end()
        else:
            IDLE[self.endpoint] = self._router

    def end_nodes(self) -> None:
        """End the nodes in this process."""
        while self._nodes:
            self._nodes.pop(0).close()

    def end_router(self) -> None:
        """End the router; robots and clients go on."""
        self._own_router = True
        self._router.end()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def ready(robot: Robot) -> Robot:
    """Clear the emergency latch, enable and calibrate the robot; return it."""
    robot.reset()
    robot.enable()
    robot.calibrate()
    return robot


def turning(robot: Robot, yaw: float = 60.0) -> Motion:
    """Begin to turn the head from home; return the motion when the arms have moved."""
    motion = robot.look(yaw=yaw, wait=False)
    until(lambda: robot.positions().commanded.short > 1, "moving")
    return motion


def assert_fails(
    request: Callable[[], object], kind: type[BeatrixError], reason: Reason, match: str | None = None
) -> None:
    """Assert that a request ends with an error of this kind and reason, whose message matches."""
    with pytest.raises(kind, match=match) as error:
        request()
    assert error.value.reason is reason


def wait_status(robot: Robot, holds: Callable[[Status], bool], what: str, timeout_s: float = EVENT_S) -> None:
    """Wait until the robot's status fulfils `holds`."""
    until(lambda: holds(robot.status()), what, timeout_s)


def raw_positions(robot: Robot) -> Positions:
    """Query the positions of a robot as it sends them, in rad and steps."""
    key = keys.positions(robot.name, robot.side)
    return ask(robot.client, robot.place, key, None, Positions, robot.timeout_s)


def ask_raw(
    client: Client,
    selector: str,
    payload: bytes | None = None,
    encoding: str | None = None,
    timeout_s: float = 8.0,
) -> list[Reply]:
    """Return all replies to a query, as a foreign client receives them."""
    return list(client.bus.query(selector, payload, encoding).replies(timeout_s))
