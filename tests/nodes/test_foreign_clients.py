"""Clients that use only Zenoh with its defaults, as Zenoh's examples do."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator

import pytest
from robots import Stage

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
