"""The second router serves the same class as the first, and serves it alone if the first fails."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator

import pytest
from class_router import Answering, ClassRouter, replies, settled
from stage import until

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated import keys


@pytest.fixture(params=["password", "certificate"])
def router(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class whose second router has another loopback address."""
    with ClassRouter(tmp_path_factory.mktemp("class"), request.param, standby="127.0.0.2") as made:
        yield made


def can_listen(address: str) -> bool:
    try:
        with socket.socket() as probe:
            probe.bind((address, 0))
    except OSError:
        return False
    return True


@pytest.mark.skipif(not can_listen("127.0.0.2"), reason="needs a second loopback address")
def test_the_second_router_takes_over_with_the_same_rules(router: ClassRouter) -> None:
    router.start_standby()
    robot, ana, teacher = (router.session(name) for name in ("bea1", "ana", "teacher"))
    Answering(robot, keys.command("bea1", "hw", "*"))
    robot.declare_token(keys.alive("bea1", "hw"))
    settled(robot)
    own, another = keys.command("bea1", "hw", "ana"), keys.command("bea1", "hw", "ben")

    account = router.account("ben")
    with zbus.connect(router.classroom.standby_listen, account=account) as elsewhere:
        until(lambda: elsewhere.robots() == [("bea1", "hw")], "routers are linked")
        until(lambda: bool(replies(elsewhere, another)), "the robot answers through the second router")
        assert not replies(elsewhere, own), "the second router has the rules, too"

    assert replies(ana, own)
    router.process.end(signal.SIGKILL)
    until(lambda: bool(replies(ana, own)), "seat and robot are connected through the second router")
    assert not replies(ana, another)
    until(lambda: teacher.robots() == [("bea1", "hw")], "the teacher is connected, too")

    router.start_again()
    with zbus.connect(router.classroom.listen, account=account) as back:
        until(lambda: back.robots() == [("bea1", "hw")], "the first router is linked again")
        until(lambda: bool(replies(back, another)), "the robot answers through the first router again")
