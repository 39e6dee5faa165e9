"""A stage for node tests: a router, and robots as real processes on it."""

from __future__ import annotations

import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Self

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Status
from beatrix_zenoh.bus import Answer
from beatrix_zenoh.client import Client
from beatrix_zenoh.node import Node, Roads
from beatrix_zenoh.settings import Settings
from hw_node.body import VirtualHardware

START_S = 20.0
"""A busy machine with two test processes may need this long to import MuJoCo."""
END_S = 10.0
PATIENCE_S = 10.0
"""For an answer on a machine that runs two test processes."""
ROOT = Path(__file__).resolve().parent.parent
UNTRACED = {name: value for name, value in os.environ.items() if name != "COVERAGE_PROCESS_CONFIG"}
"""For who is interrupted while busy: a KeyboardInterrupt inside coverage's tracer leaves its lock taken for ever."""


def free_endpoint() -> str:
    """A loopback endpoint nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def until(holds: Callable[[], bool], what: str, timeout_s: float = 5.0) -> None:
    """Poll a condition that has no event of its own, to a deadline."""
    deadline = time.monotonic() + timeout_s
    pause = threading.Event()
    while not holds():
        assert time.monotonic() < deadline, f"not within {timeout_s} s: {what}"
        pause.wait(0.01)


class Process:
    """A child process whose output lines are read as they come."""

    def __init__(self, *command: str, listens: bool = False, traced: bool = True) -> None:
        self._child = subprocess.Popen(
            [sys.executable, *command],
            stdin=subprocess.PIPE if listens else None,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=ROOT,
            env=dict(os.environ if traced else UNTRACED, PYTHONUNBUFFERED="1"),
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

    def expect(self, beginning: str, timeout_s: float = START_S) -> str:
        """The next line that begins so."""
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

    def say(self, line: str) -> None:
        """Write a line to its standard input."""
        assert self._child.stdin is not None, "started with listens=True"
        self._child.stdin.write(line + "\n")
        self._child.stdin.flush()

    def send(self, number: signal.Signals) -> None:
        """Send a signal."""
        self._child.send_signal(number)

    def wait(self, timeout_s: float = END_S) -> int:
        """Exit code, when it has ended."""
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
        """End it if it still runs; exit code."""
        if self._child.poll() is None:
            self._child.send_signal(signal.SIGCONT)
            self._child.send_signal(number)
        try:
            return self.wait()
        except subprocess.TimeoutExpired:
            self._child.kill()
            self.wait()
            raise


class Stage:
    """A router in this process, robots in processes of their own, clients here; all ended on exit."""

    def __init__(self) -> None:
        self.endpoint = free_endpoint()
        self._router = zbus.open_router(self.endpoint)
        self._processes: list[Process] = []
        self._nodes: list[Node] = []
        self._clients: list[Client] = []

    def process(self, module: str, *arguments: str) -> Process:
        """Start a process that is ended with the stage."""
        return self._started(Process("-m", module, *arguments))

    def script(self, path: Path, *arguments: str) -> Process:
        """Start a Python program that is ended with the stage."""
        return self._started(Process(str(path), *arguments))

    def _started(self, process: Process) -> Process:
        self._processes.append(process)
        return process

    def simulation(self, name: str, *arguments: str) -> Process:
        """A simulation that serves."""
        process = self.process("sim_node", "--name", name, "--connect", self.endpoint, *arguments)
        process.expect("ready")
        return process

    def hardware(self, name: str, port: str = "virtual:") -> Process:
        """A hardware node that serves."""
        process = self.process("hw_node", "--name", name, "--connect", self.endpoint, "--port", port)
        process.expect("ready")
        return process

    def mega(self, path: Path, *options: str) -> Process:
        """A simulated Mega with the shipped firmware, a port at `path`; options and words are those of tests/avr/live.py."""
        process = self._started(Process("tests/avr/live.py", "--path", str(path), *options, listens=True))
        process.expect("ready")
        return process

    def node(self, name: str) -> Node:
        """A node on the virtual board inside this process."""
        node = Node(Roads.open(lambda: zbus.connect(self.endpoint)), name, VirtualHardware(name))
        self._nodes.append(node)
        return node

    def client(self, who: str = "ana") -> Client:
        """A client's session."""
        client = Client(Settings("bea", self.endpoint, who))
        self._clients.append(client)
        return client

    def robot(self, name: str, twin: str, who: str = "ana") -> Robot:
        """A robot through a session of its own."""
        return Robot(name, twin, client=self.client(who), timeout_s=PATIENCE_S)

    def close(self) -> None:
        """Clients first, then robots, their boards, the router last."""
        for client in self._clients:
            client.close()
        for node in self._nodes:
            node.close()
        for process in reversed(self._processes):
            process.end()
        self._router.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def ready(robot: Robot) -> Robot:
    """Motors on and calibrated."""
    robot.enable()
    robot.calibrate()
    return robot


def wait_status(robot: Robot, holds: Callable[[Status], bool], what: str, timeout_s: float = 5.0) -> None:
    """Until the robot's status fulfils `holds`."""
    until(lambda: holds(robot.status()), what, timeout_s)


def ask_raw(
    client: Client,
    selector: str,
    payload: bytes | None = None,
    encoding: str | None = None,
    timeout_s: float = 8.0,
) -> list[Answer]:
    """All replies to a query, as a foreign client sees them."""
    question = client.bus.question(selector, payload, encoding)
    deadline = time.monotonic() + timeout_s
    answers = []
    try:
        while (answer := question.next(deadline - time.monotonic())) is not None:
            answers.append(answer)
    finally:
        question.close()
    return answers
