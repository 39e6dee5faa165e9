"""A user of the command line, and robots at the same router."""

from __future__ import annotations

import contextlib
import io
import json
import logging
import os
import signal
import subprocess
import sys
import threading
import time
import unittest.mock
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from robots import ROOT, Process, free_endpoint, until, untraced

from beatrix_zenoh import Robot
from beatrix_zenoh.cli import app
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.node.pauses import QUIET_S
from beatrix_zenoh.shutdown import SIGNALS

CLI = ("-m", "beatrix_zenoh.cli")
NAME = "bea1"


@contextlib.contextmanager
def settings_of_this_process() -> Iterator[None]:
    """Restore signal handlers, thread hook and switch interval at the end.

    A serving program changes them and does not restore them, because its process ends with it.
    """
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    hook, interval_s = threading.excepthook, sys.getswitchinterval()
    try:
        yield
    finally:
        threading.excepthook = hook
        sys.setswitchinterval(interval_s)
        if threading.current_thread() is threading.main_thread():
            for number, handler in handlers.items():
                signal.signal(number, handler)


def beatrix(*words: str, answers: str = "") -> subprocess.CompletedProcess[str]:
    """Run `beatrix` to its end in this process, which avoids new imports; `answers` are its input."""
    stdout, stderr = io.StringIO(), io.StringIO()
    warnings = logging.StreamHandler(stderr)
    warnings.setLevel(logging.WARNING)  # as Python prints log records without a handler
    logging.getLogger().addHandler(warnings)
    try:
        with (
            unittest.mock.patch.object(sys, "stdin", io.StringIO(answers)),
            contextlib.redirect_stdout(stdout),
            contextlib.redirect_stderr(stderr),
            settings_of_this_process(),
        ):
            code = app.run(list(words))
    finally:
        logging.getLogger().removeHandler(warnings)
    return subprocess.CompletedProcess(words, code, stdout.getvalue(), stderr.getvalue())


def good(*words: str) -> str:
    """Run `beatrix` with success; return its output."""
    done = beatrix(*words)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


class Shell:
    """A user who types commands for one router."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint

    def environment(self) -> dict[str, str]:
        kept = {key: value for key, value in untraced().items() if not key.startswith("BEATRIX_")}
        return {**kept, "BEATRIX_CONNECT": self.endpoint, "BEATRIX_WHO": "ana", "PYTHONPATH": str(ROOT)}

    def run(self, *words: str, cwd: Path = ROOT, **more: str) -> subprocess.CompletedProcess[str]:
        """Run a command to its end."""
        with (
            unittest.mock.patch.dict(os.environ, {**self.environment(), **more}, clear=True),
            contextlib.chdir(cwd),
        ):
            return beatrix(*words)

    def good(self, *words: str) -> str:
        done = self.run(*words)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def json(self, *words: str) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self.run(*words, "--json").stdout)
        return document

    def start(self, *words: str, background: bool = False) -> subprocess.Popen[str]:
        """Start a command; `background`: as a shell does in a script for a command that ends with `&`."""
        shell = ("sh", "-c", 'trap "" INT; exec "$@"', "sh") if background else ()
        return subprocess.Popen(
            [*shell, sys.executable, *CLI, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=self.environment(),
            cwd=ROOT,
        )

    def robot(self, side: str) -> Robot:
        return Robot(NAME, side, connect=self.endpoint, who="ana")


@contextlib.contextmanager
def both() -> Iterator[Shell]:
    """Start router, simulation and virtual robot with `beatrix up`; test_cli_serving.py counts its coverage."""
    endpoint = free_endpoint()
    where = ("--connect", endpoint, "--name", NAME)
    up = Process(*CLI, "up", *where, "--hw", "virtual:", "--ready", traced=False)
    try:
        up.expect("router ")
        made = Shell(endpoint)
        made.good("enable", "--on", "hw")
        made.good("calibrate", "--on", "hw")
        yield made
    finally:
        assert up.end(signal.SIGINT) == 0


def wait_until_free(shell: Shell, seat: str = "ana") -> None:
    """Wait until new programs of a seat may move the robots; other seats wait for the end of its lease."""
    with shell.robot("hw") as hardware, shell.robot("sim") as simulation:
        until(
            lambda: is_free(hardware, seat) and is_free(simulation, seat), f"both are free for {seat}", 10.0
        )


def is_free(robot: Robot, seat: str) -> bool:
    """Return whether the arms rest, no other seat holds the robot, and the pause after another seat's STOP has ended.

    A seat's own STOP pauses no program that it starts later.
    """
    status = robot.status()
    stops = (event for event in robot.past_events() if event.kind is EventKind.STOP and event.seat != seat)
    last_ns = max((event.t_wall_ns for event in stops), default=0)
    return not status.moving and status.holder in ("", seat) and time.time_ns() - last_ns > QUIET_S * 1e9
