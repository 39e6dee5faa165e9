"""Somebody who types `beatrix`, and the robots he types at."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from stage import ROOT, Process, free_endpoint, until

from beatrix_zenoh import Robot

CLI = ("-m", "beatrix_zenoh.cli")
NAME = "bea1"


class Shell:
    """Somebody who types at one router."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint

    def environment(self) -> dict[str, str]:
        kept = {key: value for key, value in os.environ.items() if not key.startswith("BEATRIX_")}
        return {**kept, "BEATRIX_CONNECT": self.endpoint, "BEATRIX_WHO": "ana", "PYTHONPATH": str(ROOT)}

    def run(self, *words: str, cwd: Path = ROOT, **more: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, *CLI, *words]
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            env={**self.environment(), **more},
            timeout=30,
            check=False,
            cwd=cwd,
        )
        assert "Traceback" not in done.stderr, done.stderr
        return done

    def good(self, *words: str) -> str:
        done = self.run(*words)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def json(self, *words: str) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self.run(*words, "--json").stdout)
        return document

    def start(self, *words: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, *CLI, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=self.environment(),
            cwd=ROOT,
        )

    def robot(self, twin: str) -> Robot:
        return Robot(NAME, twin, connect=self.endpoint, who="ana")


@contextmanager
def both() -> Iterator[Shell]:
    """Router, simulation and virtual robot by `beatrix up`."""
    endpoint = free_endpoint()
    where = ("--connect", endpoint, "--name", NAME)
    up = Process(*CLI, "up", *where, "--hw", "virtual:", "--ready", "--json")
    try:
        up.expect('{"result":true')
        made = Shell(endpoint)
        made.good("enable", "--on", "hw")
        made.good("calibrate", "--on", "hw")
        yield made
    finally:
        assert up.end(signal.SIGINT) == 0


@contextmanager
def another(shell: Shell, name: str) -> Iterator[Process]:
    """One more robot at the same router."""
    process = Process(*CLI, "hw", "--name", name, "--port", "virtual:", "--connect", shell.endpoint)
    try:
        process.expect("ready")
        yield process
    finally:
        process.end()


def wait_until_free(shell: Shell) -> None:
    """Nobody drives: who was stopped must pause, and a driver keeps the robot for a while."""
    with shell.robot("hw") as hardware, shell.robot("sim") as simulation:
        until(lambda: not (hardware.status().holder or simulation.status().holder), "both are free")
