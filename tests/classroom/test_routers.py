"""The two routers of a class: what a seat declares ends or delays at most that of the seats, and both are started again."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Self

import pytest
from class_router import CLI, ClassRouter, end, start_node
from patient_connections import PATIENCE_S, patiently
from robots import Process, ready, until

from beatrix_zenoh import Robot
from beatrix_zenoh.bus.router import DEPTH, below
from beatrix_zenoh.classroom.router_file import Part
from beatrix_zenoh.classroom.router_process import OUT_S, TOKENS_MAX, WINDOW_S, Guests
from beatrix_zenoh.classroom.routers import OFTEN, STUCK, ended
from beatrix_zenoh.client import lease, lesson_reports
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction, LessonState

PROGRAM = """
import sys, time
from pathlib import Path
import zenoh
from beatrix_zenoh import NoAnswer, account, bus
own = account.load(Path(sys.argv[1]))
while True:
    try:
        session = bus.connect(own.connect, account=own)._session
        break
    except NoAnswer:  # the router of the seats is being started again
        time.sleep(0.1)
kind, number = sys.argv[2], int(sys.argv[3])
if kind == "subscriber":
    kept = session.declare_subscriber("x" + "/a" * number, lambda _: None)
elif kind == "own queryable":
    kept = session.declare_queryable("beatrix/ana" + "/a" * number, lambda query: query.drop())
elif kind == "any subscriber":
    kept = session.declare_subscriber("beatrix/**" + "/a" * number, lambda _: None)
else:
    kept = [session.liveliness().declare_token(f"beatrix/@seat/ana/{i}") for i in range(number)]
time.sleep(0.3)  # until the router has read it
session.close()
"""
"""A program of a seat that makes a declaration, or many."""


@pytest.fixture(scope="module")
def teacher(router: ClassRouter, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    """The robot bea1 through the teacher's session."""
    node = start_node(tmp_path_factory.mktemp("bea1"), router.path("bea1"))
    with router.client("teacher") as client:
        yield ready(Robot("bea1", "hw", client=client, timeout_s=PATIENCE_S))
    assert node.end() == 0


class Stops:
    """Presses STOP again and again in a thread; `waits_s` are the times until each answer."""

    def __init__(self, robot: Robot) -> None:
        self.waits_s: list[float] = []
        self._robot, self._ended = robot, threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        while not self._ended.wait(0.02):
            begin_s = time.monotonic()
            assert self._robot.stop().result
            self.waits_s.append(time.monotonic() - begin_s)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._ended.set()
        self._thread.join(PATIENCE_S)


MORE = pytest.mark.long("two more attacks of the same kind")


def attack(router: ClassRouter, kind: str, number: int) -> None:
    """Let the seat ana make declarations, in a process of its own."""
    process = Process("-c", PROGRAM, str(router.path("ana")), kind, str(number))
    assert process.wait(PATIENCE_S) == 0, process.lines


@pytest.mark.parametrize(
    ("kind", "number", "report"),
    [
        ("subscriber", 30_000, "The router of the seats has ended (SIGABRT)"),
        pytest.param("any subscriber", 30_000, "", marks=MORE),
        pytest.param("own queryable", 30_000, "", marks=MORE),
        ("tokens", 2 * TOKENS_MAX, "ana announced more programs"),
    ],
)
def test_what_a_seat_declares_reaches_neither_robots_nor_teacher(
    router: ClassRouter, teacher: Robot, kind: str, number: int, report: str
) -> None:
    losses = teacher.client.losses
    events = len(teacher.past_events())
    with Stops(teacher) as stops:
        attack(router, kind, number)
    assert max(stops.waits_s) < PATIENCE_S
    assert teacher.client.losses == losses, "the teacher stayed connected"
    assert "router" not in "".join(event.message for event in teacher.past_events()[events:])
    if report:
        router.process.expect(report)
    router.client("ben").close()


def test_both_routers_come_back_with_robots_seats_freeze_mute_and_lessons(
    router: ClassRouter, teacher: Robot
) -> None:
    ben = router.session("ben")
    report = codec.encode(LessonState(tries=2, passed=True, hints=0, stuck=0, version=1))
    patiently(
        lambda: lease.ask(teacher, LeaseAction.FREEZE)
    )  # the robot still counts the tokens of the attack
    patiently(lambda: lease.ask(teacher, LeaseAction.MUTE, seat="ben"))

    def arrived() -> bool:
        ben.put(keys.lesson("ben", "01-hello"), report, codec.MSGPACK)
        return bool(lesson_reports.read(teacher.client))

    until(arrived, "a report")
    for part in Part:
        before = len(router.process.lines)
        end(router, part)
        router.process.expect(f"The {part.called} has ended (SIGKILL)")
        until(lambda: ben.connected and bool(ben.robots()), "the seat sees the robot")
        until(lambda: teacher.client.bus.connected and bool(teacher.client.bus.robots()), "the teacher, too")
        router.process.expect(f"The {part.called} runs again")
        if part is Part.ROBOTS:
            ended = [line for line in router.process.lines[before:] if "has ended" in line]
            assert len(ended) == 1, "the router of the seats goes on"
    status = patiently(teacher.status)
    assert (status.frozen, status.muted) == (True, ["ben"])
    assert [(row.seat, row.words) for row in patiently(lambda: lesson_reports.read(teacher.client))] == [
        ("ben", "passed (2)")
    ]
    lease.ask(teacher, LeaseAction.UNFREEZE)
    lease.ask(teacher, LeaseAction.UNMUTE, seat="ben")


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP], ids=["ends", "is stuck"])
def test_stop_is_sent_again_until_the_router_is_back(
    router: ClassRouter, teacher: Robot, tmp_path: Path, how: signal.Signals
) -> None:
    until(lambda: teacher.client.bus.router_answers(1.0), "the router")
    (tmp_path / "beatrix.toml").write_text(f'account = "{router.path("teacher")}"\n')
    end(router, Part.ROBOTS, how)
    stop = Process(*CLI, "stop", "--name", "bea1", folder=tmp_path)
    assert stop.wait(PATIENCE_S) == 0, stop.lines
    router.process.expect(
        f"The {Part.ROBOTS.called} has ended ({STUCK if how is signal.SIGSTOP else how.name})"
    )
    until(lambda: bool(teacher.client.bus.robots()), "the teacher is connected again")


def test_seats_are_out_for_a_while_when_the_router_of_the_robots_ends_again_and_again(tmp_path: Path) -> None:
    """Both routers then end with their parent, even if it is killed."""
    with ClassRouter(tmp_path) as own:
        teacher, ana = own.session("teacher"), own.session("ana")
        report = ""
        for _ in range(OFTEN):
            until(lambda: teacher.connected and teacher.router_answers(1.0), "the teacher")
            end(own, Part.ROBOTS)
            report = own.process.expect(f"The {Part.ROBOTS.called} has ended")
        assert report.endswith("Connected were: ana, teacher.")
        own.process.expect("The seats are out for 60 s")
        until(lambda: not ana.connected, "the seats are out")
        until(lambda: teacher.router_answers(1.0), "the teacher")
        assert not ana.connected
        own.process.send(signal.SIGKILL)
        until(lambda: not teacher.connected, "no router is left")


# -- decisions, without a network ---------------------------------------------------------------------


class Ended:
    """The addresses whose connections were ended."""

    def __init__(self) -> None:
        self.addresses: set[str] = set()

    def __call__(self, addresses: Collection[str]) -> None:
        self.addresses |= set(addresses)


def test_an_account_with_too_many_tokens_is_put_out_for_a_while_and_no_other() -> None:
    ended = Ended()
    guests = Guests(["ana", "ben"], ended)
    guests.link("ana", "1:1", 0.0, opened=True)
    guests.link("ben", "2:1", 0.0, opened=True)
    assert not any(guests.token("ana", i * WINDOW_S / TOKENS_MAX * 1.01) for i in range(3 * TOKENS_MAX))
    assert not any(guests.token("ben", 0.0) for _ in range(TOKENS_MAX))
    assert not guests.token("a robot of the other router", 0.0)
    assert guests.token("ben", WINDOW_S)
    assert ended.addresses == {"2:1"}
    guests.link("ben", "2:1", 0.0, opened=False)
    guests.link("ben", "2:2", WINDOW_S + OUT_S - 1, opened=True)
    guests.link("ben", "2:3", WINDOW_S + OUT_S, opened=True)
    assert ended.addresses == {"2:1", "2:2"}
    assert guests.connected == ["ana", "ben"]


def test_after_three_ends_the_report_names_the_accounts_that_were_always_connected() -> None:
    connected = [frozenset({"ana", "cem"}), frozenset({"ben", "cem"}), frozenset({"cem"})]
    first = ended(Part.SEATS, "SIGSEGV", connected[0], 1, connected[:1])
    assert "SIGSEGV" in first
    assert first.endswith("Connected were: ana, cem.")
    third = ended(Part.SEATS, "SIGSEGV", connected[2], OFTEN, connected)
    assert "Connected each time: cem. To put an account out" in third


def test_no_rule_for_declarations_includes_keys_of_any_length() -> None:
    assert all("**" not in rule and rule.count("/") < DEPTH for rule in below("beatrix"))
    assert max(row.key.count("/") for row in keys.KEYS.values()) < DEPTH - 1
