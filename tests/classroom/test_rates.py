"""Limits of the router: rate of pictures, size of messages, open files, connections that send nothing."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh
from class_router import Answering, ClassRouter, ReceivedKeys

from beatrix_zenoh.bus import credentials, is_listening
from beatrix_zenoh.bus.router import LARGEST_REQUEST
from beatrix_zenoh.bus.transport import LARGEST_MESSAGE, opened
from beatrix_zenoh.contract._generated import keys

PICTURES = 50
HUGE = 100_000_000


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class whose routers begin with a low limit of open files."""
    inside = ("prlimit", "--nofile=256:4096") if shutil.which("prlimit") else ()
    with ClassRouter(tmp_path_factory.mktemp("class"), inside=inside) as made:
        yield made


def test_each_camera_has_a_limited_rate_of_its_own_and_positions_have_none(router: ClassRouter) -> None:
    robot, teacher = router.session("bea1"), router.session("teacher")
    cameras = [keys.camera("bea1", "hw", eye) for eye in ("left", "right")]
    positions, marker = keys.positions("bea1", "hw"), keys.status("bea1", "hw")
    received = ReceivedKeys(teacher, "beatrix/**")
    router.settled(teacher)
    for _ in range(PICTURES):
        for key in (*cameras, positions):
            robot.put(key, b"1", "image/jpeg", priority="data")
    robot.put(marker, b"1", "text/plain", priority="data")
    found = received.until(marker)
    received.close()
    assert found.count(positions) == PICTURES
    for camera in cameras:
        assert 1 <= found.count(camera) < PICTURES / 2


def test_an_oversize_message_is_dropped(router: ClassRouter) -> None:
    robot, teacher = router.session("bea1"), router.session("teacher")
    large, marker = keys.positions("bea1", "sim"), keys.status("bea1", "sim")
    received = ReceivedKeys(teacher, "beatrix/**")
    router.settled(teacher)
    for key, size in ((large, LARGEST_MESSAGE + 1), (marker, LARGEST_MESSAGE // 2)):
        robot.put(key, bytes(size), "text/plain", priority="data")
    assert large not in received.until(marker)
    received.close()


def resident(pid: int) -> int:
    """Return the largest memory (kB) that a process has had."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmHWM")).split()[1])


@pytest.mark.skipif(sys.platform != "linux", reason="reads the memory of a process in /proc")
def test_a_huge_message_does_not_fill_the_memory_of_the_router(router: ClassRouter) -> None:
    account, ana = router.account("ana"), router.session("ana")
    before = resident(router.process.pid)
    settings = {"mode": "client", "connect/endpoints": [account.connect], **credentials.settings(account)}
    hostile = opened(settings, "")
    try:
        hostile.put(
            keys.positions("ana", "sim"), bytes(HUGE), congestion_control=zenoh.CongestionControl.BLOCK
        )
    finally:
        hostile.close()
    router.settled(ana)
    assert (resident(router.process.pid) - before) * 1024 < HUGE / 4


@pytest.mark.skipif(shutil.which("prlimit") is None, reason="needs a program that lowers a limit")
def test_the_router_raises_its_limit_of_open_files(router: ClassRouter) -> None:
    limits = Path(f"/proc/{router.process.pid}/limits").read_text()
    assert ["Max", "open", "files", "4096", "4096", "files"] in [line.split() for line in limits.splitlines()]


def test_an_oversize_request_reaches_no_robot(router: ClassRouter) -> None:
    robot, ana = router.session("bea2"), router.session("ana")
    served = Answering(robot, keys.motion("bea2", "hw", "*"))
    router.settled(robot)
    own = keys.motion("bea2", "hw", "ana")
    for size in (LARGEST_REQUEST + 1, LARGEST_REQUEST // 2):
        query = ana.query(own, bytes(size), timeout_s=5.0)
        while query.next(5.0) is not None:
            pass
        query.close()
    assert served.asked == [own]


@pytest.mark.skipif(
    sys.platform != "linux", reason="elsewhere a router also accepts connections that send nothing"
)
def test_probes_keep_no_session_out(router: ClassRouter) -> None:
    """If the router noticed the probes, it would accept no session for 0.1 s after each of them, 30 s altogether."""
    assert all(is_listening(router.account("ana").connect) for _ in range(300))
    router.open("ana").close()
