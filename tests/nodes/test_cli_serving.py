"""Verbs that serve: one Ctrl-C ends all they started, and nothing survives them."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from pty_board import PtyBoard
from stage import Process, free_endpoint, until

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.cli import app

CLI = ("-m", "beatrix_zenoh.cli")


@pytest.fixture
def endpoint() -> str:
    """A free one."""
    return free_endpoint()


def alive(number: int) -> bool:
    """The process runs."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def children(process: Process) -> dict[str, int]:
    """Verb and number of the processes somebody started."""
    found = {}
    for listing in Path(f"/proc/{process.pid}/task").glob("*/children"):
        for number in listing.read_text().split():
            words = Path(f"/proc/{number}/cmdline").read_text().split("\0")
            found[words[words.index("-m") + 2]] = int(number)
    return found


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where processes put their temporary files."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


@pytest.fixture
def up(endpoint: str, temporary: Path) -> Iterator[Process]:
    """Router, simulation and virtual robot."""
    process = Process(*CLI, "up", "--connect", endpoint, "--name", "bea", "--hw", "virtual:")
    try:
        process.expect("router")
        process.expect("What they write")
        yield process
    finally:
        process.end(signal.SIGKILL)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_router_says_that_it_is_ready_and_ends_cleanly(endpoint: str, number: signal.Signals) -> None:
    router = Process(*CLI, "router", "--listen", endpoint)
    assert router.expect("ready") == f"ready {endpoint}"
    zbus.connect(endpoint).close()
    assert router.end(number) == 0


def test_second_router_at_an_endpoint_is_refused(endpoint: str) -> None:
    first = Process(*CLI, "router", "--listen", endpoint)
    first.expect("ready")
    second = Process(*CLI, "router", "--listen", endpoint)
    assert second.wait() == 3
    assert any("another router" in line for line in second.lines)
    assert first.end() == 0


ELSEWHERE = "tcp/192.0.2.7:7447"
"""An address for documentation (RFC 5737): nobody's, so not ours."""


def test_router_at_the_address_of_another_computer_is_wrong_usage() -> None:
    router = Process(*CLI, "router", "--listen", ELSEWHERE)
    assert router.wait() == 2
    assert any("0.0.0.0" in line for line in router.lines)


def test_up_does_not_start_the_router_of_another_computer(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(zbus, "listens", lambda _: False)  # asking would leave this computer
    assert app.run(["up", "--connect", ELSEWHERE]) == 3
    assert "start one there with `beatrix router --listen tcp/0.0.0.0:7447`" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("host", "ours"),
    [
        ("127.0.0.1", True),
        ("localhost", True),
        ("0.0.0.0", True),
        ("192.0.2.7", False),
    ],
)
def test_only_an_address_of_this_computer_can_be_listened_at(host: str, *, ours: bool) -> None:
    code = "import sys; from beatrix_zenoh import bus; sys.exit(not bus.ours(sys.argv[1]))"
    assert (Process("-c", code, f"tcp/{host}:7447").wait() == 0) is ours


def test_a_port_or_a_path_that_is_no_text_is_told(endpoint: str, tmp_path: Path) -> None:
    odd = os.fsdecode(b"/tmp/\xff")
    robot = Process(*CLI, "hw", "--port", odd, "--connect", endpoint)
    assert robot.wait() == 2
    assert any("whose name is no text" in line for line in robot.lines)
    with zbus.open_router(endpoint):
        path = os.fsdecode(os.fsencode(tmp_path) + b"/\xff")
        robot = Process(*CLI, "hw", "--port", "virtual:", "--legacy", path, "--connect", endpoint)
        robot.expect("ready")
        assert robot.end() == 0


def test_options_of_a_process_pass_through(endpoint: str) -> None:
    robot = Process(*CLI, "hw", "--help")
    assert robot.wait() == 0
    assert any("--port" in line for line in robot.lines)
    wrong = Process(*CLI, "sim", "--nonsense", "--connect", endpoint)
    assert wrong.wait() == 2


def test_a_board_in_software_without_its_colon_is_wrong_usage_before_any_router_is_missed() -> None:
    robot = Process(*CLI, "hw", "--port", "virtual", "--connect", free_endpoint())
    assert robot.wait() == 2
    assert any("with a colon" in line for line in robot.lines)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_up_ends_everything_with_one_signal(up: Process, number: signal.Signals, temporary: Path) -> None:
    started = children(up)
    assert set(started) == {"router", "sim", "hw"}
    assert up.end(number) == 0
    assert not list(temporary.iterdir())
    assert not [verb for verb, process in started.items() if alive(process)]


def test_nothing_survives_a_killed_up(up: Process, temporary: Path) -> None:
    started = children(up)
    up.end(signal.SIGKILL)
    until(lambda: not any(alive(process) for process in started.values()), "all have ended", 10)
    assert list(temporary.iterdir())
    another = Process(*CLI, "up", "--connect", free_endpoint(), "--no-sim", "--hw", "virtual:")
    another.expect("What they write")
    assert another.end(signal.SIGINT) == 0
    assert not list(temporary.iterdir())


def test_up_ends_the_rest_and_fails_when_one_dies(up: Process) -> None:
    started = children(up)
    os.kill(started["sim"], signal.SIGKILL)
    assert up.wait() == 1
    assert any("simulation has ended" in line for line in up.lines)
    assert any(line.startswith("  ready beatrix/") for line in up.lines), "its last words"
    assert not [verb for verb, process in started.items() if alive(process)]


def test_up_says_when_the_board_is_lost_and_when_it_is_back(endpoint: str, tmp_path: Path) -> None:
    with PtyBoard(tmp_path / "board") as board:
        up = Process(*CLI, "up", "--connect", endpoint, "--no-sim", "--hw", str(board.path))
        up.expect("What they write")
        board.unplug()
        up.expect(f"hardware: {board.path} is not there: plug the board in")
        board.plug()
        up.expect(f"hardware: The board at {board.path} is there.")
        assert up.end() == 0


def test_up_uses_a_router_that_is_there_and_leaves_it(endpoint: str) -> None:
    session = zbus.open_router(endpoint)
    up = Process(*CLI, "up", "--connect", endpoint, "--name", "bea", "--no-sim", "--hw", "virtual:", "--json")
    try:
        document = json.loads(up.expect("{"))
        assert document["running"] == ["hardware"]
        with zbus.connect(endpoint) as bus:
            assert bus.robots() == [("bea", "hw")]
        assert up.end(signal.SIGINT) == 0
        zbus.connect(endpoint).close()
    finally:
        session.close()
        up.end(signal.SIGKILL)


def test_up_tells_that_there_is_no_board_at_the_port(endpoint: str, tmp_path: Path) -> None:
    up = Process(
        *CLI, "up", "--connect", endpoint, "--name", "bea", "--no-sim", "--hw", str(tmp_path / "tty")
    )
    try:
        assert "fault BOARD_LOST" in up.expect("hardware")
        assert "is not there: plug the board in" in up.expect("hardware:")
        up.expect("What they write")
        listing = Process(*CLI, "ls", "--connect", endpoint)
        assert listing.wait() == 0
        assert any("is not there: plug the board in" in line for line in listing.lines)
    finally:
        assert up.end(signal.SIGINT) == 0


def test_up_under_a_name_that_is_taken_says_so(up: Process, endpoint: str) -> None:
    second = Process(*CLI, "up", "--connect", endpoint, "--name", "bea")
    assert second.wait(20) == 1
    assert any("on line at" in line and "already" in line for line in second.lines)
    assert alive(up.pid)


def test_up_with_nothing_to_serve_is_wrong_usage(endpoint: str) -> None:
    assert Process(*CLI, "up", "--connect", endpoint, "--no-sim").wait() == 2
    unready = Process(*CLI, "up", "--connect", endpoint, "--no-sim", "--ready", "--hw", "virtual:")
    assert unready.wait() == 2
    assert "--ready is for the simulation" in "".join(unready.lines)
