"""Many simulations in one process: real-time factor, regularity, latencies, processor time and memory.

    python tools/bench_many.py [NUMBER ...]

NUMBER of simulations in the process (default: 1 10 20 30), each at rest and with 3 and 5 of them in motion. A program
watches the positions of all. Every second query is a bare Zenoh query behind the same router: the floor of this run.
"""

from __future__ import annotations

import json
import statistics
import sys
import threading
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import cycle, islice, pairwise

from bench_class_load import Program
from bench_node import Bare, Served, free_endpoint, spread_ms
from bench_threads import keep_moving

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import MotionReply, PoseQuery, Positions
from beatrix_zenoh.settings import Settings

NUMBERS = (1, 10, 20, 30)
MOVING = (0, 3, 5)
SETTLE_S = 6.0
"""Time (s) after a change; the real-time factor counts over 5 s."""
ASKED = 200
PAUSE_S = 0.02
"""Pause (s) before a query; the arms of a simulation that was just asked rest again when its turn comes."""


def watch(endpoint: str) -> None:
    """Receive the positions of all robots until the end of the input; for each line print what arrived since the last."""
    received: list[tuple[str, bytes]] = []
    with zbus.connect(endpoint) as bus:
        bus.subscribe(
            keys.positions("*", "sim"), lambda message: received.append((message.key, message.payload))
        )
        print("ready", flush=True)
        for _ in sys.stdin:
            taken, received[:] = received[:], []
            print(json.dumps(regularity(taken)), flush=True)


def regularity(received: list[tuple[str, bytes]]) -> dict[str, float]:
    """Return robots, lost messages, largest standard deviation of a robot's period (ms), and the longest period (ms)."""
    by_robot: dict[str, list[Positions]] = {}
    for key, payload in received:
        by_robot.setdefault(key, []).append(codec.decode(payload, Positions))
    periods = {
        key: [(after.t_mono_ns - before.t_mono_ns) / 1e6 for before, after in pairwise(messages)]
        for key, messages in by_robot.items()
    }
    return {
        "robots": len(by_robot),
        "lost": sum(all_[-1].seq - all_[0].seq + 1 - len(all_) for all_ in by_robot.values()),
        "sd_ms": max(statistics.stdev(one) for one in periods.values()),
        "longest_ms": max(map(max, periods.values())),
    }


@dataclass
class Latencies:
    """Times (s) of queries to robots at rest, and those of bare Zenoh queries in between."""

    accepted: list[float] = field(default_factory=list)
    stopped: list[float] = field(default_factory=list)
    bare: list[float] = field(default_factory=list)


def ask(robots: list[Robot], bare: Bare) -> Latencies:
    """Measure the acceptance of a pose, and STOP at rest, of one robot after the other."""
    took = Latencies()
    for number, robot in enumerate(islice(cycle(robots), ASKED)):
        time.sleep(PAUSE_S)
        began = time.perf_counter()
        bare.query()
        took.bare.append(time.perf_counter() - began)
        key = keys.pose(robot.name, robot.side, robot.client.settings.who)
        began = time.perf_counter()
        request = Request(robot.client, robot.place, key, PoseQuery(yaw=0.001 * (number % 2 + 1)), 5.0)
        reply = request.next(MotionReply, 5.0)
        took.accepted.append(time.perf_counter() - began)
        assert reply.result, reply.message
        request.close()
        robot.stop()
        began = time.perf_counter()
        robot.stop()
        took.stopped.append(time.perf_counter() - began)
    return took


def rows(number: int) -> None:
    """Print a row for each number of robots in motion."""
    with ExitStack() as stack:
        endpoint = free_endpoint()
        router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
        stack.callback(router.end)
        names = [f"seat{n:02d}" for n in range(1, number + 1)]
        words = [word for name in names for word in ("--name", name)]
        served = Served("sim_node", *words, "--ready", "--connect", endpoint)
        stack.callback(served.end)
        client = stack.enter_context(Client(Settings(names[0], endpoint, "ana")))
        robots = [Robot(name, "sim", client=client) for name in names]
        while len(client.bus.robots()) < number:
            time.sleep(0.05)
        watcher = Program(__file__, "--watch", endpoint)
        stack.callback(watcher.close)
        watcher.line()
        bare = Bare(endpoint)
        stack.callback(bare.close)
        for moving in MOVING:
            if moving <= number:
                print(row(robots, moving, served, watcher, bare), flush=True)


def row(robots: list[Robot], moving: int, served: Served, watcher: Program, bare: Bare) -> str:
    """Measure with this many robots in motion, and return the row."""
    over = threading.Event()
    threads = [threading.Thread(target=keep_moving, args=(robot, over.wait)) for robot in robots[:moving]]
    for thread in threads:
        thread.start()
    time.sleep(SETTLE_S)
    watcher.say("")
    watcher.line()
    cpu_s, began_s = served.cpu_s(), time.monotonic()
    time.sleep(SETTLE_S)
    load = (served.cpu_s() - cpu_s) / (time.monotonic() - began_s)
    plants = [plant for robot in robots if (plant := robot.status().plant) is not None]
    factors = [plant.real_time_factor for plant in plants]
    watcher.say("")
    seen = json.loads(watcher.line())
    took = ask(robots[moving:], bare) if moving < len(robots) else Latencies([0.0], [0.0], [0.0])
    over.set()
    for thread in threads:
        thread.join()
    return (
        f"{len(robots):3} {moving:3}   {min(factors):.4f} {max(factors):.4f}   {seen['sd_ms']:6.2f} {seen['longest_ms']:6.0f} "
        f"{seen['lost']:4}   {spread_ms(took.accepted):>21} {spread_ms(took.bare):>21} {spread_ms(took.stopped):>21}   "
        f"{load * 100:5.1f} {served.rss_mib():5.0f}"
    )


def main() -> None:
    """Measure, or watch for another process that measures."""
    if sys.argv[1:2] == ["--watch"]:
        watch(sys.argv[2])
        return
    print(
        "robots, in motion; real-time factor (lowest, highest); period: sd of the worst robot, longest [ms]; lost; median / "
        "p99 / largest [ms] of: query -> accepted, a bare Zenoh query, STOP at rest; processor time [% of a core]; RSS [MiB]"
    )
    for number in [int(word) for word in sys.argv[1:]] or NUMBERS:
        rows(number)


if __name__ == "__main__":
    main()
