"""Hostile and broken traffic at the router's port: other seats still work."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator

import hostile
import msgspec
import pytest
from cable import Cable
from class_router import Answering, ClassRouter, replies, start_node
from patient_connections import PATIENCE_S, patiently
from robots import ready, until

from beatrix_zenoh import Interrupted, NoAnswer, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.settings import Settings

STOPS = 3
COMMAND = keys.command("bea2", "hw", "ana")


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class with one of its robots online."""
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        node = start_node(tmp_path_factory.mktemp("bea1"), made.path("bea1"))
        yield made
        assert node.end() == 0


@pytest.fixture(scope="module")
def teacher(router: ClassRouter) -> Iterator[Robot]:
    """The robot through the teacher's session, which need not pause after its own STOP."""
    with router.client("teacher") as client:
        yield ready(Robot("bea1", "hw", client=client, timeout_s=PATIENCE_S))


def moves_and_stops(robot: Robot) -> None:
    """Assert that the robot moves, and that STOP ends the motion.

    A flood of motions may delay or drop a motion, which is then sent again; STOP is sent once. On a busy computer a
    flooded robot may lose the router for a moment: then the last reply of the motion is lost, but it still rests.
    """

    def short() -> float:
        return patiently(robot.positions).commanded.short

    start = short()
    goal = -90.0 if start > 0 else 90.0
    motion = patiently(lambda: robot.look(yaw=goal, speed=30, wait=False))
    until(lambda: abs(short() - start) > 1, "moving")
    assert robot.stop().result
    with pytest.raises((Interrupted, NoAnswer)):
        motion.wait()
    assert not patiently(robot.status).moving


@contextlib.contextmanager
def relayed(router: ClassRouter) -> Iterator[tuple[Cable, Account]]:
    """A cable that records, and the account of the seat ana for its end."""
    with Cable("127.0.0.1", router.classroom.router.port + 1) as cable:
        account = router.account("ana")
        yield cable, msgspec.structs.replace(account, connect=f"tls/127.0.0.1:{cable.port}")


def recorded_session(router: ClassRouter) -> bytes:
    """Return the bytes that a program of the seat ana sends to turn the robot."""
    with relayed(router) as (cable, account):
        with patiently(lambda: Client(Settings("", account.connect, "ana", account=account))) as client:
            Robot("bea1", "hw", client=client).look(yaw=1, speed=60)
        return bytes(max(cable.recorded, key=len))


def send_again(router: ClassRouter, pieces: list[bytes]) -> int:
    """Send the pieces one by one, each after the reply to the one before; return the number of bytes received."""
    received_bytes = 0
    with (
        contextlib.suppress(ConnectionError),
        socket.create_connection(("127.0.0.1", router.classroom.router.port + 1), PATIENCE_S) as connection,
    ):
        for piece in pieces[:-1]:
            connection.sendall(piece)
            connection.settimeout(0.3)
            with contextlib.suppress(TimeoutError):
                received_bytes += len(connection.recv(4096))
        connection.settimeout(PATIENCE_S)
        connection.sendall(pieces[-1])
        while data := connection.recv(4096):  # until the router closes it
            received_bytes += len(data)
    return received_bytes


def test_a_replayed_session_opens_no_session_and_repeats_no_request(router: ClassRouter) -> None:
    served = Answering(router.session("bea2"), keys.command("bea2", "hw", "*"))
    router.settled(router.session("bea2"))
    with (
        relayed(router) as (cable, account),
        patiently(lambda: zbus.connect(account.connect, account=account)) as session,
    ):
        token = keys.seat("ana", session.session_id)
        session.declare_token(token)
        assert replies(session, COMMAND), "the recording has a request that is carried out"
        recorded = bytes(max(cable.recorded, key=len))
        for pieces in ([recorded], hostile.frames(recorded)[:3]):
            send_again(router, pieces)
        assert replies(session, COMMAND), "the copy does not end the original session"
    teacher = router.session("teacher")
    for pieces in ([recorded], hostile.frames(recorded)):
        assert send_again(router, pieces) > 0, "the router begins a handshake, and ends it"
        assert token not in teacher.tokens(keys.seat("*", "*"), PATIENCE_S)
    assert served.asked == [COMMAND] * 2, "the recorded request has not been carried out again"
    assert replies(router.session("ana"), COMMAND)


def test_hostile_traffic_moves_no_robot_and_blocks_no_request(router: ClassRouter, teacher: Robot) -> None:
    """Nothing connects after this test: the router first works through the failed handshakes, 0.1 s for each."""
    until(lambda: not teacher.status().holder, "the robot is free")
    recorded = recorded_session(router)
    before = teacher.status().motion
    seats = teacher.client.bus.tokens(keys.seat("ana", "*"))
    with hostile.Attack("127.0.0.1", router.classroom.router.port, recorded) as attack:
        until(lambda: min(attack.sent[kind] for kind in hostile.KINDS) >= 10, "all kinds of attacks")
        assert teacher.status().motion == before, "no hostile bytes have moved the robot"
        assert teacher.client.bus.tokens(keys.seat("ana", "*")) == seats, "no session was opened"
        for _ in range(STOPS):
            moves_and_stops(teacher)
    moves_and_stops(teacher)
    moved = {event.seat for event in teacher.past_events() if event.kind is EventKind.MOTION}
    assert moved == {"ana", "teacher"}
    assert sum(event.seat == "ana" for event in teacher.past_events() if event.kind is EventKind.MOTION) == 2
