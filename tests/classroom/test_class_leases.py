"""Thirty seats and one robot: one seat drives it, and a disconnected seat loses it."""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec
import pytest
from cable import Cable
from class_router import ClassRouter, use_account
from late_tests import in_time
from patient_connections import PATIENCE_S, patiently
from robots import Process, until
from shell import beatrix
from students import PROGRAM, Seat

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Incoming, Sessions
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import EventKind, LeaseAction, Reason
from beatrix_zenoh.contract.names import SIDES, TEACHER
from beatrix_zenoh.node import Node
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


def test_one_of_thirty_seats_takes_the_robot_and_refusals_name_it(router: ClassRouter) -> None:
    gate = threading.Barrier(SEATS)

    def take(robot: Robot) -> Refused | None:
        gate.wait(PATIENCE_S)
        try:
            lease.ask(robot, LeaseAction.TAKE)
        except Refused as refused:
            return refused
        return None

    robots = [router.robot("bea1", "hw", seat) for seat in router.classroom.seats]
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
    robot = router.robot("bea1", "hw", "teacher")
    bus, key = robot.client.bus, keys.stop_unsigned("bea1", "hw")
    with contextlib.closing(robot.client), robot.events(timeout_s=PATIENCE_S) as events:
        router.settled(bus)  # a put is not repeated, so its event must find the subscription
        if form == "put":
            bus.put(key, b"", "text/plain")
        else:
            assert bus.query(keys.stop_unsigned("*", "*")).next(PATIENCE_S) is not None
        event = next(event for event in events if event.kind is EventKind.STOP)
    assert event.seat == TEACHER


@pytest.mark.long("waits for robots that do not answer")
@pytest.mark.measures_time
@pytest.mark.parametrize("kind", ["takes queries", "answers nonsense"])
def test_a_token_without_a_robot_holds_up_no_command_of_the_teacher(
    router: ClassRouter, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path("teacher")))
    held: list[Incoming] = []

    def nonsense(incoming: Incoming) -> None:
        incoming.reply(incoming.key, msgspec.msgpack.encode({"x": "y" * 900}), "application/msgpack")
        incoming.finish()

    with router.open("seat01") as fake:
        for side in SIDES:
            fake.declare_token(keys.alive("seat01", side))
            for key in (
                keys.lease("seat01", side, "*"),
                keys.info("seat01", side),
                keys.status("seat01", side),
            ):
                fake.serve(key, held.append if kind == "takes queries" else nonsense)
        began_s = time.monotonic()
        done = beatrix("mute", "seat02")
        muted_s = time.monotonic() - began_s
        shown = beatrix("ls")
        listed_s = time.monotonic() - began_s - muted_s
        table = beatrix("top", "--once").stdout
        assert beatrix("unmute", "seat02").returncode == 0
        for incoming in held:
            incoming.finish()
    assert (done.returncode, done.stdout.count("\n")) == (0, 2), "bea1, and bea2 later"
    notes = [line for line in done.stderr.splitlines() if "ignored" not in line]
    assert [line.partition(":")[0] for line in sorted(notes)[:2]] == ["seat01 (hw)", "seat01 (sim)"]
    assert done.stdout.splitlines()[1].startswith("bea2: not online. The router of the class applies it")
    assert len(done.stderr.splitlines()) <= 3
    assert all(len(line) < 350 for line in done.stderr.splitlines())
    assert "decisions differ" not in table, "the robot of a seat"
    assert len(shown.stderr.splitlines()) <= 1
    in_time(muted_s, 1.8, "mute")
    in_time(listed_s, 1.9, "ls")


@pytest.mark.long("waits for the end of a lease")
def test_a_disconnected_holder_loses_the_robot_to_the_seat_that_waits(
    router: ClassRouter, tmp_path: Path
) -> None:
    account = router.account("seat01")
    with Cable("127.0.0.1", router.classroom.router.port + 1) as cable:
        path = tmp_path / "seat01.toml"
        path.write_text(msgspec.structs.replace(account, connect=f"tls/127.0.0.1:{cable.port}").text())
        use_account(tmp_path, path)
        holder = Seat(Process(PROGRAM, folder=tmp_path, listens=True, traced=False))
        with contextlib.ExitStack() as stack:
            stack.callback(holder.process.end, signal.SIGKILL)
            next_one = router.robot("bea1", "hw", "seat02")
            stack.callback(next_one.client.close)
            until(lambda: next_one.status().holder == "", "the lease of the test before has ended")
            next_one.make_ready()
            start = next_one.positions().commanded.short
            holder.expect_ready()
            holder.does("bool(robot('bea1').lease())")
            holder.does(f"begin('bea1', {-150 if start > 0 else 150})")
            lease.ask(next_one, LeaseAction.WAIT)
            until(lambda: abs(next_one.positions().commanded.short - start) > 1, "moving")
            cable.unplug()
            until(lambda: not next_one.status().moving, "the robot stops")
            until(lambda: next_one.status().holder == "seat02", "the waiting seat gets the lease")
            assert abs(next_one.positions().commanded.short) < 140, "the motion has not reached its goal"
            assert not next_one.status().moving
            lease.ask(next_one, LeaseAction.GIVE_BACK)
