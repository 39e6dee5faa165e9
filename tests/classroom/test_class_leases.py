"""Thirty seats and one robot: one seat drives it, and a disconnected seat loses it."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from class_router import ClassRouter
from patient_connections import PATIENCE_S, patiently

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.client import Client, lease
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind, LeaseAction, Reason
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.node import Node
from beatrix_zenoh.settings import Settings
from hw_node.body import VirtualHardware

SEATS = 30


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class with one of its robots online."""
    with ClassRouter(tmp_path_factory.mktemp("class"), seats=str(SEATS)) as made:
        account = made.account("bea1")
        node = Node(
            Sessions(lambda: patiently(lambda: zbus.connect(account.connect, account=account))),
            "bea1",
            VirtualHardware("bea1"),
        ).start()
        yield made
        node.close()


def robot_of(router: ClassRouter, seat: str) -> Robot:
    """Return the robot through a new session of a seat."""
    account = router.account(seat)
    client = patiently(lambda: Client(Settings("bea1", account.connect, seat, account=account)))
    return Robot("bea1", "hw", client=client, timeout_s=PATIENCE_S)


def test_one_of_thirty_seats_takes_the_robot_and_refusals_name_it(router: ClassRouter) -> None:
    gate = threading.Barrier(SEATS)

    def take(robot: Robot) -> Refused | None:
        gate.wait(PATIENCE_S)
        try:
            lease.ask(robot, LeaseAction.TAKE)
        except Refused as refused:
            return refused
        return None

    robots = [robot_of(router, seat) for seat in router.classroom.seats]
    try:
        with ThreadPoolExecutor(SEATS) as pool:
            ends = list(pool.map(take, robots))
        holder = robots[0].status().holder
        winners = [
            seat for seat, refused in zip(router.classroom.seats, ends, strict=True) if refused is None
        ]
        assert winners == [holder]
        for refused in filter(None, ends):
            assert refused.reason is Reason.NOT_HOLDER
            assert f"{holder} has taken this robot" in refused.message
            assert refused.detail is not None
            assert refused.detail.holder == holder
    finally:
        for robot in robots:
            robot.client.close()


@pytest.mark.parametrize("form", ["put", "query of all robots"])
def test_a_stop_without_a_seat_is_the_teachers(router: ClassRouter, form: str) -> None:
    """The router of a class lets no other account send it, for example with Zenoh's own `z_put`."""
    robot = robot_of(router, "teacher")
    bus, key = robot.client.bus, keys.stop_unsigned("bea1", "hw")
    with contextlib.closing(robot.client), robot.events(timeout_s=PATIENCE_S) as events:
        router.settled(bus)  # a put is not repeated, so its event must find the subscription
        if form == "put":
            bus.put(key, b"", "text/plain")
        else:
            assert bus.query(keys.stop_unsigned("*", "*")).next(PATIENCE_S) is not None
        event = next(event for event in events if event.kind is EventKind.STOP)
    assert event.seat == TEACHER
