"""The end of programs that do not close their sessions: it takes a short time and never ends in a crash."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from robots import ROOT, Process, Stage, free_endpoint, start_router, untraced

END_S = 6.0
"""Time limit (s) of a program that needs less than one second on a quiet machine."""
FROZEN_S = 30.0
"""The same at a router that takes no more data: Zenoh tries for 10 s or more to close a session."""
BEGIN = """
import sys, time
from beatrix_zenoh import Robot, bus as zbus, threads
from beatrix_zenoh.bus import Sessions, sessions
from beatrix_zenoh.node import Node
from hw_node.body import VirtualHardware
endpoint = sys.argv[1]
"""
END = """
print("begun", flush=True)
time.sleep(0.2)
raise RuntimeError("a mistake of the user")
"""
PROGRAMS = {
    "a node whose watchdog never rests": """
sessions.PERIOD_S = 0.0001
node = Node(Sessions(lambda: zbus.connect(endpoint)), "bea2", VirtualHardware("bea2")).start()
""",
    "a function of the user's own at the exit": """
import atexit
robot = Robot("bea", "hw", connect=endpoint, who="ana")
atexit.register(lambda: print("stopped", robot.stop().result, flush=True))
""",
}


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=list(PROGRAMS))
def test_a_program_that_ends_by_an_exception_ends_soon_and_without_a_crash(
    stage: Stage, tmp_path: Path, program: str
) -> None:
    """Without the hook at the exit, four of ten such programs, or more, were aborted."""
    script = tmp_path / "program.py"
    script.write_text(BEGIN + program + END)
    child = subprocess.run(
        [sys.executable, str(script), stage.endpoint],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env=untraced() | {"PYTHONPATH": str(ROOT)},
        timeout=60.0,
        check=False,
    )
    assert child.returncode == 1, child.stderr
    assert child.stderr.rstrip().endswith("RuntimeError: a mistake of the user"), child.stderr
    assert ("stopped True" in child.stdout) == ("stopped" in program)


@pytest.mark.long("waits until Zenoh gives up")
def test_a_program_ends_although_its_router_hangs(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    router = start_router(endpoint)
    script = tmp_path / "program.py"
    fill = 'buses = [zbus.connect(endpoint) for _ in range(3)]\nprint("open", flush=True)\nsys.stdin.readline()\n'
    fill += 'for number in range(3000):\n    [bus.put("z", bytes(5000), "") for bus in buses]\n'
    script.write_text(BEGIN + fill + END)
    try:
        child = Process(str(script), endpoint, listens=True, traced=False)
        child.expect("open")
        router.send(signal.SIGSTOP)
        child.say("")
        child.expect("begun")
        begin_s = time.monotonic()
        code = child.wait(FROZEN_S + END_S)
        assert code == 1, child.lines
        assert time.monotonic() - begin_s < FROZEN_S
        assert child.lines[-1] == "RuntimeError: a mistake of the user"
    finally:
        router.end(signal.SIGKILL)
