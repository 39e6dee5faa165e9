"""How processes are asked to end and killed on other systems than this one."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import cast

import pytest
import without_posix

from beatrix_zenoh import process_groups, processes
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.legacy import no_terminal


class FakeProcess:
    """A process that ends when its standard input is closed, and writes down what is done to it."""

    def __init__(self, stdin: io.BytesIO | None, *, obeys: bool = True) -> None:
        self.stdin, self.pid, self.obeys, self.done = stdin, 7, obeys, list[str]()

    def terminate(self) -> None:
        self.done.append("terminated")

    def kill(self) -> None:
        self.done.append("killed")
        self.obeys = True

    def wait(self, timeout_s: float | None = None) -> int:
        if not self.obeys:
            raise subprocess.TimeoutExpired("beatrix", timeout_s or 0.0)
        return 0

    @property
    def popen(self) -> subprocess.Popen[bytes]:
        """The same, for mypy."""
        return cast("subprocess.Popen[bytes]", self)


@pytest.mark.parametrize(
    ("platform", "pipe", "obeys", "done"),
    [
        ("linux", True, True, ["terminated"]),
        ("darwin", True, False, ["terminated", "killed"]),
        ("win32", True, True, []),
        ("win32", True, False, ["killed"]),
        ("win32", False, True, ["terminated"]),
    ],
)
def test_a_process_is_asked_to_end_before_it_is_killed(
    monkeypatch: pytest.MonkeyPatch, platform: str, pipe: bool, obeys: bool, done: list[str]
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    process = FakeProcess(io.BytesIO() if pipe else None, obeys=obeys)
    processes.end(process.popen, 0.0)
    assert process.done == done
    assert process.stdin is None or process.stdin.closed == (platform == "win32")


@pytest.mark.parametrize(
    ("platform", "killed"), [("linux", [(7, "SIGKILL")]), ("darwin", [(7, "SIGKILL")]), ("win32", [])]
)
def test_where_a_group_cannot_be_killed_the_process_is(
    monkeypatch: pytest.MonkeyPatch, platform: str, killed: list[tuple[int, str]]
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    calls: list[tuple[int, str]] = []
    monkeypatch.setattr(os, "killpg", lambda pid, number: calls.append((pid, number.name)))
    process = FakeProcess(None)
    process_groups.kill_group(process.popen)
    assert calls == killed
    assert process.done == ([] if killed else ["killed"])


@pytest.mark.parametrize("platform", ["linux", "win32"])
def test_a_process_that_asks_itself_to_end_runs_its_handlers(
    monkeypatch: pytest.MonkeyPatch, platform: str
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    handled: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, _frame: handled.append(number))
    try:
        process_groups.ask_this_to_end()
    finally:
        signal.signal(signal.SIGTERM, before)
    assert handled == [signal.SIGTERM]


def test_windows_refuses_a_terminal_of_2023_and_says_where_there_is_one(tmp_path: Path) -> None:
    with pytest.raises(Refused, match=r"Windows does not have. Run this node on Linux or macOS"):
        no_terminal.Terminal(tmp_path / "COM4")


def test_every_module_can_be_imported_without_what_windows_lacks() -> None:
    command = [sys.executable, without_posix.__file__]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr


def test_pipes_of_our_programs_are_utf_8_in_a_locale_without_umlauts() -> None:
    command = [*processes.PYTHON[:-1], "-c", "print('Gerät')"]
    narrow = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    assert (
        subprocess.check_output(command, env=os.environ | narrow, encoding="utf-8", timeout=60) == "Gerät\n"
    )
