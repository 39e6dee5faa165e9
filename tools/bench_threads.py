"""Processor time and wake-ups of nodes, by kind of thread, and the latency of motions and STOP.

    python tools/bench_threads.py [FOLDER ...]

Each FOLDER is a checkout of this project (default: this one), for example one of the commit before. All nodes run at
the same time against one router, and are queried by turns, so that the load of the computer is the same for all.
"""

from __future__ import annotations

import re
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from bench_node import ROOT, Served, free_endpoint, spread_ms

from beatrix_zenoh import Robot
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import MotionReply, PoseQuery
from beatrix_zenoh.settings import Settings

BODIES = {"sim": ("sim_node",), "virtual": ("hw_node", "--port", "virtual:")}
SLEEP_S = 2.0
"""Pause (s) after the start, in which a simulation at home comes to rest."""
MEASURED_S = 10.0
QUERIES = 200
TURN_S = 1.2
"""Time (s) between two motions of 60° at 60°/s, one after the other without a pause."""


class Node:
    """A node of one checkout, with its client."""

    def __init__(self, folder: Path, number: int, body: str, endpoint: str, stack: ExitStack) -> None:
        name = f"{body}{number}"
        self.title = f"{body:7} {folder.resolve().name}"
        module, *options = BODIES[body]
        self._served = Served(module, "--name", name, "--connect", endpoint, *options, folder=folder)
        stack.callback(self._served.end)
        client = stack.enter_context(Client(Settings(name, endpoint, "ana")))
        self.robot = Robot(name, "sim" if body == "sim" else "hw", client=client)
        self.robot.enable()
        self.robot.calibrate()
        self.accepted_s: list[float] = []
        self.stopped_s: list[float] = []

    def threads(self) -> Counter[str]:
        """Return the processor time (ms) and the voluntary context switches so far, by kind of thread."""
        found: Counter[str] = Counter()
        for task in Path(f"/proc/{self._served.pid}/task").iterdir():
            name = re.sub(r"[-\d]+$", "", (task / "comm").read_text().strip())
            kind = "Python" if name.startswith("python") else "Zenoh"
            # CONFIG_SCHEDSTATS: time on a processor in ns; `stat` counts in ticks of 10 ms.
            found[f"{kind} us"] += int((task / "schedstat").read_text().split()[0]) // 1000
            waits = re.search(
                r"^voluntary_ctxt_switches:\s*(\d+)", (task / "status").read_text(), re.MULTILINE
            )
            found[f"{kind} wake-ups"] += int(waits[1]) if waits else 0
        return found

    def ask(self, number: int) -> None:
        """Measure the acceptance of a pose, and STOP once the arms rest again."""
        key = keys.pose(self.robot.name, self.robot.side, self.robot.client.settings.who)
        began = time.perf_counter()
        request = Request(
            self.robot.client, self.robot.place, key, PoseQuery(yaw=0.001 * (number % 2 + 1)), 5.0
        )
        reply = request.next(MotionReply, 2.0)
        self.accepted_s.append(time.perf_counter() - began)
        assert reply.result, reply.message
        request.close()
        self.robot.stop()
        began = time.perf_counter()
        self.robot.stop()
        self.stopped_s.append(time.perf_counter() - began)


def measure(title: str, nodes: list[Node]) -> None:
    """Print the load of all nodes during MEASURED_S."""
    before, began_s = [node.threads() for node in nodes], time.monotonic()
    time.sleep(MEASURED_S)
    after, took_s = [node.threads() for node in nodes], time.monotonic() - began_s
    print(f"{title}: processor time [% of a core] (Python, Zenoh), wake-ups a second (Python, Zenoh)")
    for node, first, last in zip(nodes, before, after, strict=True):
        used = {kind: (last[kind] - first[kind]) / took_s for kind in last}
        python, zenoh = used["Python us"] / 1e4, used["Zenoh us"] / 1e4
        wakes = f"{used['Python wake-ups']:.0f}, {used['Zenoh wake-ups']:.0f}"
        print(f"    {node.title:24} {python + zenoh:5.1f} ({python:.1f}, {zenoh:.1f})   {wakes}", flush=True)


def keep_moving(robot: Robot, over: Callable[[float], bool]) -> None:
    """Turn the head to and fro until `over` returns True."""
    turn = 1
    while not over(TURN_S):
        robot.look(yaw=30 * turn, speed=60, wait=False)
        turn = -turn


def main() -> None:
    """Measure nodes of all checkouts."""
    folders = [Path(word) for word in sys.argv[1:]] or [ROOT]
    with ExitStack() as stack:
        router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint := free_endpoint())
        stack.callback(router.end)
        nodes = [
            Node(folder, number, body, endpoint, stack)
            for body in BODIES
            for number, folder in enumerate(folders)
        ]
        time.sleep(SLEEP_S)
        measure("at rest, not watched", nodes)
        watching = [node.robot.positions_stream() for node in nodes]
        time.sleep(1)
        measure("at rest, watched", nodes)
        for number in range(QUERIES):
            for node in nodes:
                node.ask(number)
        print("query -> accepted; STOP at rest -> answered: median / p99 / largest [ms]")
        for node in nodes:
            print(f"    {node.title:24} {spread_ms(node.accepted_s)}   {spread_ms(node.stopped_s)}")
        over = threading.Event()
        stack.callback(over.set)
        threads = [threading.Thread(target=keep_moving, args=(node.robot, over.wait)) for node in nodes]
        for thread in threads:
            thread.start()
        time.sleep(1)
        measure("in motion, watched", nodes)
        over.set()
        for thread in threads:
            thread.join()
        for stream in watching:
            stream.close()


if __name__ == "__main__":
    main()
