"""Verbs that serve: one Ctrl-C ends all their processes."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from old_programs import Program
from robots import Process, Stage, children, free_endpoint, until
from shell import CLI

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.cli import app


@pytest.fixture
def endpoint() -> str:
    """A free endpoint."""
    return free_endpoint()


def alive(number: int) -> bool:
    """Return whether the process runs."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def verbs(process: Process) -> dict[str, int]:
    """Return the process number of each child by its verb."""
    found = children(process.pid).items()
    return {command.partition("--with-parent ")[2].split()[0]: number for number, command in found}


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder for temporary files of processes."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


@contextlib.contextmanager
def running_up(endpoint: str, *options: str) -> Iterator[Process]:
    """Run `beatrix up` with a virtual robot; kill it if the test has not ended it."""
    robot = ("--name", "bea", "--no-sim", "--hw", "virtual:")
    process = Process(*CLI, "up", "--connect", endpoint, *robot, *options)
    try:
        yield process
    finally:
        process.end(signal.SIGKILL)


@pytest.fixture
def up(endpoint: str, temporary: Path) -> Iterator[Process]:
    """`beatrix up`, with router and virtual robot."""
    with running_up(endpoint) as process:
        process.expect("router")
        process.expect("The output of all processes")
        yield process


ELSEWHERE = "tcp/192.0.2.7:7447"
"""An address for documentation (RFC 5737), which no computer has."""


def test_up_does_not_start_the_router_of_another_computer(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(zbus, "is_listening", lambda _: False)  # no test connects to another computer
    assert app.run(["up", "--connect", ELSEWHERE]) == 3
    assert "beatrix router --listen tcp/0.0.0.0:7447" in capsys.readouterr().err


def test_the_ready_line_says_that_there_is_no_board(alone: Stage, temporary: Path) -> None:
    robot = alone.hardware("bea", f"{temporary}/COM9")
    assert robot.lines[-1] == "ready beatrix/bea/hw/@alive (no board yet)"


@pytest.mark.usefixtures("hangup")
def test_up_ends_everything_with_one_signal(up: Process, temporary: Path) -> None:
    """The shell of other tests ends `up` with SIGINT, and a simulation with it."""
    started = verbs(up)
    assert set(started) == {"router", "hw"}
    assert up.end(signal.SIGHUP) == 0
    assert not list(temporary.iterdir())
    assert not [verb for verb, process in started.items() if alive(process)]


def test_all_children_end_when_up_is_killed(up: Process) -> None:
    started = verbs(up)
    up.end(signal.SIGKILL)
    until(lambda: not any(alive(process) for process in started.values()), "all have ended")


def test_up_ends_all_processes_and_fails_when_the_router_ends(up: Process) -> None:
    started = verbs(up)
    os.kill(started["router"], signal.SIGKILL)
    assert up.wait() == 1
    assert any("router has ended (SIGKILL)" in line for line in up.lines)
    assert any(line.startswith("  ready tcp/") for line in up.lines), "the last lines of the router are shown"
    assert not [verb for verb, process in started.items() if alive(process)]


def test_up_starts_a_crashed_robot_again_once(up: Process, endpoint: str) -> None:
    started = verbs(up)
    os.kill(started["hw"], signal.SIGKILL)
    up.expect("The hardware has ended (SIGKILL). It is started again, as if it had just been switched on.")
    assert up.expect("hardware: ready") == "hardware: ready beatrix/bea/hw/@alive"
    after = verbs(up)
    assert after["router"] == started["router"]
    assert after["hw"] != started["hw"]
    with Robot("bea", "hw", connect=endpoint) as robot:
        robot.make_ready()
        robot.look(yaw=2)
    os.kill(after["hw"], signal.SIGKILL)
    up.expect("The hardware has ended (SIGKILL) and stays down.")
    command = up.expect("To start it again: beatrix hw --name bea").removeprefix(
        "To start it again: beatrix "
    )
    assert verbs(up) == {"router": started["router"]}
    by_hand = Process(*CLI, *command.split())
    by_hand.expect("ready beatrix/bea/hw/@alive")
    assert by_hand.end() == 0
    assert up.end(signal.SIGINT) == 0


def test_up_uses_a_running_router_and_leaves_it_running(alone: Stage) -> None:
    with running_up(alone.endpoint) as up:
        assert up.expect("router").endswith("runs already")
        up.expect("The output of all processes")
        with zbus.connect(alone.endpoint) as bus:
            assert bus.robots() == [("bea", "hw")]
        assert up.end(signal.SIGINT) == 0
        zbus.connect(alone.endpoint).close()


def test_up_gives_old_programs_a_port(endpoint: str, tmp_path: Path) -> None:
    path = tmp_path / "ttyACM0"
    with running_up(endpoint, "--legacy", str(path)) as up:
        assert up.expect("Programs of 2023 open") == f"Programs of 2023 open {path} and drive the hardware."
        program = Program(path)
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        program.port.close()
        assert up.end(signal.SIGINT) == 0
        assert not path.is_symlink()
