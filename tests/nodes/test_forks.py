"""Programs that fork: multiprocessing with the start method fork, process pools, os.fork. Nothing of them may hang."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from robots import Stage

from beatrix_zenoh.bus.forks import CURE
from sim_node.body import Simulation

START = """
import json, multiprocessing, os, signal, sys, threading, time, warnings
from concurrent.futures import ProcessPoolExecutor
from beatrix_zenoh import BeatrixError, Monitor, Robot, Twin
warnings.simplefilter("ignore", DeprecationWarning)  # since Python 3.12 for a fork in a process with threads
os.environ["BEATRIX_CONNECT"], os.environ["BEATRIX_WHO"] = sys.argv[1], "ana"
LIMIT_S = 10.0

def in_fork(do, *, end=os._exit):
    '''Call `do` in a forked child; return its result or error, or that it hangs.'''
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        try:
            text = "returned " + str(do())
        except BaseException as error:
            text = type(error).__name__ + ": " + str(error)
        os.write(writer, text.encode())
        os.close(writer)
        end(0)
    os.close(writer)
    deadline = time.monotonic() + LIMIT_S
    while os.waitpid(child, os.WNOHANG) == (0, 0):
        if time.monotonic() > deadline:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return "hangs"
        time.sleep(0.002)
    with open(reader) as pipe:
        return pipe.read()
"""
USED = (
    START
    + """
robot = Robot("bea1")
robot.make_ready()
twin, stream, monitor = Twin("bea1"), robot.stream(timeout_s=None), Monitor(robot.client)
lease = robot.lease()
motion = robot.move(60, 60, 60, speed=6, wait=False)
iterator = iter(stream)
next(iterator)
bound = robot.look
threading.Thread(target=motion.result, daemon=True).start()  # holds a lock of the motion
threading.Thread(target=robot.events().next, daemon=True).start()
robot.client._lock.acquire()  # as a thread that opens the session of the cameras
REFUSED = {
    "positions": robot.positions, "look": lambda: robot.look(10), "stop": robot.stop, "lease": robot.lease,
    "with": lambda: robot.__enter__(), "bound": lambda: bound(10), "for": lambda: next(iter(stream)),
    "iterator": lambda: next(iterator), "stream.latest": lambda: stream.latest, "motion.result": motion.result,
    "twin.look": lambda: twin.look(10), "monitor": lambda: monitor.robots(), "client": robot.client.robots,
    "new robot": lambda: Robot("bea1"), "new twin": lambda: Twin("bea1"),
}
CLOSED = {
    "robot.close": lambda: robot.close(), "stream.close": lambda: stream.close(), "lease.close": lambda: lease.close(),
    "twin.close": lambda: twin.close(), "monitor.close": lambda: monitor.close(), "exit": lambda: robot.__exit__(),
    "client.close": robot.client.close,
}
found = {kind: {name: in_fork(do) for name, do in uses.items()} for kind, uses in (("refused", REFUSED), ("closed", CLOSED))}
found["end"] = in_fork(lambda: None, end=sys.exit)
robot.client._lock.release()
found["parent"] = robot.move(0, 0, 0).result().result
print(json.dumps(found), flush=True)
"""
)
"""Every use of inherited objects in a child, while threads of the parent wait and hold locks."""


POOLS = (
    START
    + """
import pickle
from multiprocessing import get_context

def enabled(name):
    with Robot(name) as robot:
        return robot.status().enabled

def use(robot):
    return robot.status().enabled

def refuse():
    with Robot("bea1") as robot:
        robot.look(pitch=60)

def in_pool(method, do, *arguments):
    '''Call `do` in a pool of one process; return its result or error.'''
    with ProcessPoolExecutor(1, mp_context=get_context(method)) as pool:
        try:
            return pool.submit(do, *arguments).result(30)
        except BeatrixError as error:
            return [type(error).__name__, error.message, error.reason]

if __name__ == "__main__":
    found = {"fork before": in_pool("fork", enabled, "bea1")}
    robot = Robot("bea1")
    found["fork"] = in_pool("fork", enabled, "bea1")
    found["spawn"] = in_pool("spawn", enabled, "bea1")
    found["passed"] = in_pool("spawn", use, robot)
    found["refused"] = in_pool("spawn", refuse)
    try:
        pickle.dumps(robot)
    except BeatrixError as error:
        found["pickled"] = error.message
    robot.close()
    found["fork after close"] = in_pool("fork", enabled, "bea1")
    print(json.dumps(found), flush=True)
"""
)
"""Process pools, before, during and after a connection of the parent; and pickling."""


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.node("bea1", Simulation("bea1")).make_ready()
        made.node("bea1")
        yield made


def results(stage: Stage, text: str, folder: Path) -> dict[str, Any]:
    """Run a program and return what it prints as JSON."""
    program = folder / "program.py"
    program.write_text(text, encoding="utf-8")
    process = stage.script(program, stage.endpoint)
    found: dict[str, Any] = json.loads(process.expect("{"))
    assert process.wait() == 0
    return found


def test_every_use_of_an_inherited_object_is_refused_at_once(stage: Stage, tmp_path: Path) -> None:
    found = results(stage, USED, tmp_path)
    for name, outcome in found["refused"].items():
        assert (outcome.partition(":")[0], outcome.endswith(CURE)) == ("WrongUsage", True), (name, outcome)
    assert {*found["closed"].values()} == {"returned None"}
    assert (found["end"], found["parent"]) == ("returned None", True)


def test_a_child_of_a_process_that_has_connected_is_refused_and_others_work(
    stage: Stage, tmp_path: Path
) -> None:
    found = results(stage, POOLS, tmp_path)
    assert [found[name] for name in ("fork before", "spawn")] == [True, True]
    for name in ("fork", "fork after close"):
        kind, sentence, _ = found[name]
        assert kind == "WrongUsage"
        assert sentence.startswith("This process cannot connect, because process ")
        assert sentence.endswith(CURE)
    assert found["passed"][0] == "WrongUsage"
    assert found["refused"][::2] == ["Refused", "OUT_OF_REACH"], "an error reaches the parent with its reason"
    assert found["pickled"].startswith(
        "Robot works only in the process that created it, so it can neither be"
    )
