"""A lesson is read from the log alone: which seat asked for what, how, and what came of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from robots import Stage, ask_raw, ready, until
from shell import Shell

from beatrix_zenoh import Refused
from beatrix_zenoh.client import lease
from beatrix_zenoh.client.choreography import Choreography, Pose, play
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction

ASKED = (
    "ana asked look yaw 20.0°, pitch 0.0°, roll 0.0° at 60°/s, from Python: Accepted",
    "ana asked move relative short 2.0°, middle -2.0°, long 0.5° at 60, 50, 40°/s, from Python: Accepted",
    "from Python, refused OUT_OF_REACH: The head would",
    "at 85.944°/s, over Zenoh: Accepted",
    "ana asked look yaw 5.0°, pitch 0.0°, roll 0.0° at 60°/s, from the command line: Accepted",
    "at 60°/s, from a choreography: Accepted",
    "ana stop STOP",
    "arm-topics asked move short 5.73°",
)


def test_every_request_is_in_the_log_file_with_its_seat_source_and_outcome(tmp_path: Path) -> None:
    log = tmp_path / "lesson.log"
    with Stage() as stage:
        stage.hardware("bea", "virtual:", "--log-file", str(log))
        robot = ready(stage.robot("bea", "hw", "ana"))
        robot.look(yaw=20, speed=60)
        robot.move(2, -2, 0.5, relative=True, speed=(60, 50, 40))
        with pytest.raises(Refused):
            robot.look(pitch=60)
        ask_raw(robot.client, keys.pose("bea", "hw", "ana") + "?yaw=0.1;pitch=0.05;speed=1.5")
        Shell(stage.endpoint).good("look", "--yaw", "5", "--speed", "60", "--name", "bea", "--on", "hw")
        play(robot, Choreography([("nod", Pose(0.0, 0.0, 5.0, 0.0, 60.0))]))
        robot.stop()
        lease.ask(stage.robot("bea", "hw", "teacher"), LeaseAction.GIVE_BACK)
        robot.client.bus.put(keys.arm_target("bea", "hw", "short"), b"0.1", "text/plain")
        until(lambda: "arm-topics" in log.read_text(encoding="utf-8"), "the last line")
    text = log.read_text(encoding="utf-8")
    at = -1
    for words in ASKED:
        at = text.find(words, at + 1)
        assert at >= 0, f"{words!r} is missing, or not in order:\n{text}"
    assert len(re.findall(r" ana motion pose \d+ done: Arrived", text)) >= 3
