"""Log records of a node: an unread stderr must not block the robot."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys

import pytest
from robots import ROOT, Stage, ready, until, untraced

from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind

SMALLEST_PIPE = 4096


@pytest.mark.long("fills a pipe")
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux can set the size of a pipe")
def test_an_unread_stderr_does_not_block_the_node(alone: Stage) -> None:
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, SMALLEST_PIPE)
    command = ["-m", "hw_node", "--name", "bea", "--connect", alone.endpoint, "--port", "virtual:"]
    node = subprocess.Popen(
        [sys.executable, *command],
        stdout=subprocess.PIPE,
        stderr=writer,
        text=True,
        cwd=ROOT,
        env=untraced(),
    )
    os.close(writer)
    try:
        assert node.stdout is not None
        assert node.stdout.readline().startswith("ready")
        robot = ready(alone.robot("bea", "hw"))
        with robot.events(timeout_s=20.0) as events:
            written = 0

            def filled() -> bool:
                nonlocal written
                robot.client.bus.put(keys.arm_target("bea", "hw", "a" * 200), b"0", "text/plain")
                events_read = events.take(0.05)
                written += sum(len(event.message) for event in events_read if event.kind is EventKind.WARNING)
                return written > SMALLEST_PIPE + 1000

            until(filled, "more than the pipe holds", 40.0)
        robot.look(yaw=5, speed=60)
        assert robot.stop().result
        node.send_signal(signal.SIGTERM)
        assert node.wait() == 0
    finally:
        node.kill()
        node.communicate()
        os.close(reader)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has /dev/full")
def test_a_full_disk_is_reported_once_and_the_node_ends_cleanly(alone: Stage) -> None:
    node = alone.hardware("bea", "virtual:", "--log-file", "/dev/full")
    robot = ready(alone.robot("bea", "hw"))
    robot.look(yaw=2, speed=60)
    node.send(signal.SIGINT)
    assert node.wait() == 0
    assert sum("Nothing more is written there" in line for line in node.lines) == 1
    assert not any("Traceback" in line for line in node.lines)
