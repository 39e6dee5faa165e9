"""A check that is killed, or watches and is ended, takes the pupil's program and its simulation with it."""

from __future__ import annotations

import os
import signal
import socket
import sys
from pathlib import Path

import pytest
from robots import EVENT_S, START_S, Process, until

from beatrix_zenoh.bus import is_listening

PROGRAM = """
import os, socket
test = socket.create_connection(("127.0.0.1", {port}))
test.sendall(os.environ["BEATRIX_CONNECT"].encode())
if os.fork() == 0:
    while True:
        pass
9**9**9  # lets no other thread run
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL and no fork")
@pytest.mark.parametrize(
    ("verb", "how"),
    [
        ("check", signal.SIGKILL),
        pytest.param("watch", signal.SIGINT, marks=pytest.mark.long("starts a robot for a second time")),
    ],
)
def test_a_killed_check_leaves_no_process(verb: str, how: signal.Signals, tmp_path: Path) -> None:
    def lesson(*words: str) -> Process:
        return Process("-m", "beatrix_zenoh.cli", "lesson", *words, "1", folder=tmp_path, traced=False)

    assert lesson("start").wait() == 0
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(START_S)
        program = tmp_path / "lessons/01-hello/start.py"
        program.write_text(PROGRAM.format(port=server.getsockname()[1]))
        check = lesson(verb)
        connection, _ = server.accept()
    with connection:
        connection.settimeout(EVENT_S)
        endpoint = connection.recv(100).decode()
        assert is_listening(endpoint)
        os.kill(check.pid, how)
        assert connection.recv(100) == b"", "it is closed when the program and its fork have ended"
    until(lambda: not is_listening(endpoint), "the end of the router")
    check.wait()
