"""A stranger without an account who sends nonsense keeps out no newcomer, if the rules of `classroom init` are loaded."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from class_router import ClassRouter
from school_network import ROUTER, School, permits_namespaces

pytestmark = [
    pytest.mark.long("several computers in network namespaces"),
    pytest.mark.skipif(
        not permits_namespaces() or shutil.which("nft") is None, reason="needs network namespaces and nft(8)"
    ),
]

JOINS_S = 5.0
"""Longest time (s) until a newcomer is connected."""
STRANGER = """
import os, socket, sys, time
for number in range(int(20 * float(sys.argv[3]))):
    if number == 100:
        print("flood", flush=True)
    for port in (int(sys.argv[2]), int(sys.argv[2]) + 1):
        try:
            with socket.create_connection((sys.argv[1], port), 0.05) as connection:
                connection.sendall(os.urandom(60))
        except OSError:
            pass
    time.sleep(0.05)
"""
"""A program that opens 20 connections a second to each router, and sends nonsense."""
NEWCOMER = """
import sys, time
from pathlib import Path
from beatrix_zenoh import NoAnswer, account, bus
own = account.load(Path(sys.argv[1]))
begin_s = time.monotonic()
while True:
    try:
        bus.connect(own.connect, account=own).close()
        break
    except NoAnswer:
        time.sleep(0.1)
print("connected", time.monotonic() - begin_s, flush=True)
"""


def test_a_stranger_keeps_no_newcomer_out(tmp_path: Path) -> None:
    with School(tmp_path) as school:
        stranger, ana, bea1 = (school.host(name) for name in ("stranger", "ana", "bea1"))
        with ClassRouter(tmp_path, inside=school.router.inside, address=ROUTER) as router:
            rules = router.folder / "connections.nft"
            for _ in range(2):  # a second time they replace themselves
                subprocess.run([*school.router.inside, "nft", "-f", str(rules)], check=True, timeout=10)
            flood = stranger.start("-c", STRANGER, ROUTER, str(router.classroom.router.port), "20")
            flood.expect("flood")  # it has used up what the rules let through at first
            for host, name in ((ana, "ana"), (bea1, "bea1")):
                newcomer = host.start("-c", NEWCOMER, str(router.path(name)))
                line = newcomer.expect("connected")
                assert float(line.split()[1]) < JOINS_S, (name, line)
