"""Faults of the router: robots stop when it is lost, and all sessions connect again when it returns."""

from __future__ import annotations

import contextlib
import math
import re
import signal
import socket
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest
import zenoh
from patient_connections import PATIENCE_S, patiently
from robots import Stage, free_endpoint, ready, routing, start_router, until
from shell import Shell

from beatrix_zenoh import Interrupted, NoAnswer, Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions, session, transport
from beatrix_zenoh.cli import commands
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated.messages import LeaseAction, Reason
from beatrix_zenoh.node import Node
from beatrix_zenoh.terminal.options import Which
from hw_node.body import VirtualHardware


def refused(robot: Robot) -> bool:
    """Send a motion; return whether it fails, for example because of a late notice that this client was lost."""
    try:
        robot.look(yaw=1, speed=60)
    except (Refused, NoAnswer, Interrupted):
        return True
    return False


def failed(request: Callable[[], object]) -> NoAnswer:
    """Return the error of a request."""
    with pytest.raises(NoAnswer) as caught:
        request()
    return caught.value


def test_all_processes_return_after_a_restart_of_the_router_process(alone: Stage) -> None:
    endpoint = free_endpoint()
    router = start_router(endpoint)
    node = alone.process("hw_node", "--name", "bea", "--connect", endpoint, "--port", "virtual:")
    node.expect("ready")
    with Robot("bea", "hw", connect=endpoint, who="ana") as robot:
        robot.make_ready()
        motion = robot.look(yaw=30, wait=False)
        router.end(signal.SIGKILL)
        with pytest.raises(NoAnswer, match="is lost, so the robots stop their motions"):
            motion.wait()
        node.expect(f"The router at {endpoint} was lost: the node stops all motions")
        with pytest.raises(NoAnswer, match="is lost, so the robots stop their motions"):
            robot.look(yaw=4)
        with routing(endpoint):
            until(lambda: robot.client.bus.robots(0.3) == [("bea", "hw")], "back online")
            node.expect(f"The router at {endpoint} is connected again.")
            until(lambda: not refused(robot), "the seat is connected again")
            node.end()


def test_a_taken_robot_stays_held_while_the_router_is_lost_and_returns() -> None:
    endpoint = free_endpoint()
    with contextlib.ExitStack() as stack:
        with routing(endpoint):
            node = Node(Sessions(lambda: zbus.connect(endpoint)), "bea", VirtualHardware("bea")).start()
            stack.callback(node.close)
            pool = stack.enter_context(ThreadPoolExecutor())
            robot = stack.enter_context(Robot("bea", "hw", connect=endpoint, who="ana"))
            holds = pool.submit(commands.lease, commands.What.TAKE, 0.0, "bea", endpoint, "ana", Which.HW)
            until(lambda: robot.status().lease == 1, "ana has taken it")
        with pytest.raises(TimeoutError):
            holds.result(2.0)
        with routing(endpoint):
            patiently(lambda: lease.ask(robot, LeaseAction.GIVE_BACK))
            with pytest.raises(Refused, match="your lease has ended"):
                holds.result(PATIENCE_S)


def test_a_node_that_is_started_before_the_router_waits_for_it(alone: Stage) -> None:
    endpoint = free_endpoint()
    process = alone.process("hw_node", "--name", "bea", "--connect", endpoint, "--port", "virtual:")
    assert f"`beatrix router --listen {endpoint}`" in process.expect("No router at")
    with routing(endpoint):
        process.expect("ready beatrix/bea/hw/@alive")
        process.end()
    waiting = alone.process("hw_node", "--name", "bea", "--connect", endpoint, "--port", "virtual:")
    waiting.expect("No router at")
    waiting.send(signal.SIGINT)
    assert waiting.wait() == 0


def test_a_suspended_router_counts_as_lost(alone: Stage) -> None:
    endpoint = free_endpoint()
    router = start_router(endpoint)
    node = Node(Sessions(lambda: zbus.connect(endpoint)), "bea", VirtualHardware("bea")).start()
    sentence = r"does not answer: it hangs or is very busy\. Robots stop by themselves within 3 s"
    try:
        with Robot("bea", "hw", connect=endpoint, who="ana") as robot:
            ready(robot).look(yaw=150, speed=10, wait=False)
            until(lambda: node.controller.arms()[0] > 0.05, "moving")
            router.send(signal.SIGSTOP)
            with ThreadPoolExecutor() as pool:
                stop = pool.submit(failed, robot.stop)
                opened = pool.submit(failed, lambda: Robot("bea", "hw", connect=endpoint, who="ben"))
                done = Shell(endpoint).run("stop")
            for text in (done.stderr, stop.result().message, opened.result().message):
                assert re.search(sentence, text)
            assert (done.returncode, stop.result().reason) == (3, Reason.NO_ROUTER)
            until(lambda: not node.snapshot.status().moving, "stopped after a silence of 2 s")
            assert 0 < node.controller.arms()[0] < math.radians(100), "not at its goal"
            router.send(signal.SIGCONT)
            until(lambda: not refused(robot), "all sessions are connected again")
    finally:
        node.close()
        router.end()


@pytest.mark.long("waits until a session is replaced")
@pytest.mark.parametrize("traffic", ["control", "motion"])
def test_a_session_whose_declarations_the_router_has_lost_is_replaced(alone: Stage, traffic: str) -> None:
    node = alone.node("bea")
    robot = ready(alone.robot("bea", "hw"))
    stream = robot.stream()
    robot.look(yaw=2)
    motion = robot.look(yaw=170, speed=10, wait=False)
    bus = node.sessions.opened()[traffic]
    forgotten = bus._session
    for declared in bus._made.values():
        if not isinstance(declared, zenoh.Publisher):
            declared.undeclare()  # as after a reconnection that lost them
    until(
        lambda: any("has connected again" in warning for warning in node.controller.diagnostics.warnings()),
        "the node warns of the loss",
        10.0,
    )
    until(lambda: bool(forgotten.is_closed()), "the router has no declarations of the session")
    until(lambda: not node.snapshot.status().moving, "the motion is stopped, because its reply may be lost")
    with pytest.raises((Interrupted, NoAnswer)):
        motion.wait()
    until(lambda: not robot.status().holder, "free")
    stream.take()
    robot.look(yaw=4)
    assert robot.stop().result
    assert robot.status().warnings
    assert stream.take(2.0)
    assert robot.client.bus.robots() == [("bea", "hw")]


def accepted(server: socket.socket) -> socket.socket | None:
    """Return the next connection; None after `shutdown`."""
    try:
        return server.accept()[0]
    except OSError:
        return None


@pytest.mark.parametrize(
    ("answer", "reason", "named"),
    [
        (
            b"\x02\x00\x03\x02",
            Reason.NO_ROUTER,
            "another version of Zenoh",
        ),  # recorded from eclipse-zenoh 0.11.0
        (b"SSH-2.0\r\n", Reason.ACCOUNT_REFUSED, "it is no router"),
    ],
)
def test_a_router_of_another_protocol_version_is_named_as_such(
    answer: bytes, reason: Reason, named: str
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            while (connection := accepted(server)) is not None:
                with connection, contextlib.suppress(OSError):  # a probe resets the connection
                    if connection.recv(4096):
                        connection.sendall(answer)

        serving = threading.Thread(target=serve, name="other-router")
        serving.start()
        with pytest.raises(NoAnswer) as refused:
            zbus.connect(f"tcp/127.0.0.1:{server.getsockname()[1]}")
        server.shutdown(socket.SHUT_RDWR)
        serving.join()
    assert (refused.value.reason, named in refused.value.message) == (reason, True)


def test_a_router_that_begins_to_listen_after_the_first_attempt_refuses_no_one(
    alone: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    attempts: list[bool] = []

    def opened(*given: object) -> zenoh.Session:
        attempts.append(True)
        if len(attempts) == 1:
            raise NoAnswer(Reason.ACCOUNT_REFUSED, "")
        return transport.opened(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(session, "opened", opened)
    zbus.connect(alone.endpoint).close()
    assert len(attempts) == 2
