"""Clients that use only Zenoh with its defaults, as Zenoh's examples do."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from robots import Stage, free_endpoint, until

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.node import Node
from hw_node.body import VirtualHardware
from sim_node.body import Simulation

GET = """
import json, sys, zenoh
config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", json.dumps([sys.argv[1]]))
with zenoh.open(config) as session:
    payload = sys.argv[3] if len(sys.argv) > 3 else None
    for reply in session.get(sys.argv[2], payload=payload, timeout=8):
        print(reply.ok.payload.to_string())
"""

BEGIN = """
import sys, zenoh
config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", f'["{sys.argv[1]}"]')
session = zenoh.open(config)
list(session.get("beatrix/bea/hw/cmd/me/pose?yaw=2;speed=0.5", timeout=60))
"""


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.node("bea", Simulation("bea"))
        yield made


def get(stage: Stage, selector: str, *payload: str) -> list[dict[str, object]]:
    """Return the replies that a plain `session.get` in another process receives."""
    command = [sys.executable, "-c", GET, stage.endpoint, f"beatrix/bea/sim/{selector}", *payload]
    result = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True)
    return [json.loads(line) for line in result.stdout.splitlines()]


def test_a_plain_get_enables_calibrates_and_moves_the_robot(stage: Stage) -> None:
    (refused,) = get(stage, "cmd/me/pose?yaw=0.2")
    assert (refused["result"], refused["reason"]) == (False, "NOT_ENABLED")
    assert [reply["result"] for reply in get(stage, "cmd/me/command?command=enable")] == [True]
    assert [reply["result"] for reply in get(stage, "cmd/me/command", '{"command":2}')] == [True]
    (done,) = get(stage, "cmd/me/pose?yaw=0.1;speed=1")
    assert (done["result"], done["phase"]) == (True, "done"), "the last reply is the one that is kept"
    (positions,) = get(stage, "state/positions")
    head = positions["head"]
    assert isinstance(head, dict)
    assert head["yaw"] == pytest.approx(0.1, abs=0.01)
    (stopped,) = get(stage, "stop")
    assert stopped["result"] is True


def test_the_motion_of_a_client_without_a_token_ends_when_the_router_is_lost(tmp_path: Path) -> None:
    program = tmp_path / "begin.py"
    program.write_text(BEGIN)
    with Stage() as stage:
        endpoint = free_endpoint()
        router = stage.process("beatrix_zenoh.cli", "router", "--listen", endpoint)
        router.expect("ready")
        node = Node(Sessions(lambda: zbus.connect(endpoint)), "bea", VirtualHardware("bea")).start()
        try:
            node.make_ready()
            stage.script(program, endpoint)
            until(lambda: node.controller.arms()[0] > 0.1, "moving", 10.0)
            router.end(signal.SIGKILL)
            until(lambda: not node.snapshot.status().moving, "stopped")
            assert 0 < node.controller.arms()[0] < 1.5
            assert node.snapshot.status().holder == ""
        finally:
            node.close()
