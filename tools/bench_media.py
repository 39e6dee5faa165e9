"""Benchmark of pictures over a real router on loopback, in real processes: rows of (quantity, measured, required).

`python tools/bench_media.py` prints them alone.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from itertools import pairwise

import simplejpeg
from bench_node import ROOT, Row, Served, free_endpoint, receive, regularity, spread_ms

from beatrix_zenoh import Robot
from beatrix_zenoh.client import Client, subscription
from beatrix_zenoh.client.subscription import CameraImage
from beatrix_zenoh.contract.names import EYES
from beatrix_zenoh.settings import Settings
from hw_node.cameras.stand_ins import number_and_time

NAME = "bench-media"
LASTS_S = 10.0
KEPT = 1000
SUBSCRIBER = """
import sys
from beatrix_zenoh import Robot
with Robot(sys.argv[1], "hw", connect=sys.argv[2]) as robot:
    left, right = robot.camera("left"), robot.camera("right")
    left.next(), right.next()
    print("ready", flush=True)
    while True:
        left.next(), right.next()
"""


def watched(robot: Robot, seconds: float) -> dict[str, list[CameraImage]]:
    """Return all pictures of both eyes that arrive within a time (s)."""
    with ExitStack() as stack:
        eyes = {
            eye: stack.enter_context(
                subscription.images(robot.client, *robot.place, eye, timeout_s=5.0, length=KEPT)
            )
            for eye in EYES
        }
        for images in eyes.values():
            images.next()
        time.sleep(seconds)
        return {eye: images.take() for eye, images in eyes.items()}


def lost(pictures: list[CameraImage]) -> int:
    """Return the number of pictures that are missing by sequence number, or show another number than their header."""
    by_header = pictures[-1].seq - pictures[0].seq + 1 - len(pictures)
    numbers = [number_and_time(simplejpeg.decode_jpeg(one.jpeg))[0] for one in pictures]
    wrong = sum(number != one.seq for number, one in zip(numbers, pictures, strict=True))
    return by_header + wrong


def describe(seen: dict[str, list[CameraImage]]) -> str:
    """Format the rate of each eye (Hz), the number of lost pictures, and the longest time between two (ms)."""
    rates = [1e9 * (len(one) - 1) / (one[-1].t_mono_ns - one[0].t_mono_ns) for one in seen.values()]
    gaps = [(b.arrived_mono_ns - a.arrived_mono_ns) / 1e6 for one in seen.values() for a, b in pairwise(one)]
    missing = sum(map(lost, seen.values()))
    return f"{rates[0]:.2f} + {rates[1]:.2f}, {missing}, {max(gaps):.0f}"


@contextmanager
def frozen_subscriber(endpoint: str) -> Iterator[None]:
    """Run another client that subscribes to both eyes and then stops reading, as a suspended laptop does."""
    child = subprocess.Popen(
        [sys.executable, "-c", SUBSCRIBER, NAME, endpoint], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert child.stdout is not None
    child.stdout.readline()
    child.send_signal(signal.SIGSTOP)
    try:
        yield
    finally:
        child.kill()
        child.wait()


def rows(endpoint: str) -> Iterator[Row]:
    """Yield all measurements of a hardware node whose two eyes show the test picture."""
    node = Served("hw_node", "--name", NAME, "--connect", endpoint, "--port", "virtual:")
    client = Client(Settings(NAME, endpoint, "ana"))
    robot = Robot(NAME, "hw", client=client)
    time.sleep(1.0)

    before = node.cpu_s()
    time.sleep(LASTS_S)
    idle = (node.cpu_s() - before) / LASTS_S

    before = node.cpu_s()
    seen = watched(robot, LASTS_S)
    busy = (node.cpu_s() - before) / LASTS_S
    ages = [(one.arrived_mono_ns - one.t_mono_ns) / 1e9 for pictures in seen.values() for one in pictures]
    size = sum(len(one.jpeg) for one in seen["left"]) / len(seen["left"]) / 1000

    with ExitStack() as stack:
        for eye in EYES:
            stack.enter_context(robot.camera(eye))
        positions = regularity(receive(robot, LASTS_S))
    with frozen_subscriber(endpoint):
        beside = watched(robot, LASTS_S)
    client.close()
    node.end()

    yield (
        f"cameras, test picture of {size:.0f} kB: [Hz], lost, longest gap [ms]",
        describe(seen),
        "30 + 30, 0",
    )
    yield "cameras: exposure -> client [ms]", spread_ms(ages), ""
    yield (
        "cameras: CPU of the node, no subscriber / both eyes [% of a core]",
        f"{idle * 100:.1f} / {busy * 100:.1f}",
        "",
    )
    yield "cameras: positions meanwhile [Hz], sd of period [ms], lost", positions, "50, < 1, 0"
    yield "cameras beside a frozen subscriber: [Hz], lost, longest gap [ms]", describe(beside), "30 + 30, 0"


def main() -> None:
    """Print the rows."""
    endpoint = free_endpoint()
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    try:
        for figure, measured, to_reach in rows(endpoint):
            print(f"{figure:<75} {measured:<28} {to_reach}")
    finally:
        router.end()


if __name__ == "__main__":
    main()
