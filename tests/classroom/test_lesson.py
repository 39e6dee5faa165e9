"""A lesson: real nodes and clients, each with its account, at the router of a class."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from class_router import CLI, ClassRouter, start_node, use_account
from robots import Process, ready, until
from shell import beatrix

from beatrix_zenoh import Robot
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.contract.errors import NoAnswer, Refused
from beatrix_zenoh.lessons import program, turns
from beatrix_zenoh.settings import Settings

LOOKS_FOR_ACCOUNT = """
import os, sys
from pathlib import Path
from beatrix_zenoh import Robot
from beatrix_zenoh.account import joined
with Robot() as robot:
    robot.look(yaw=10)
    print("reached", round(robot.positions().head.yaw), robot.client.settings.who)
print("account", robot.client.settings.account, repr(os.environ["BEATRIX_ACCOUNT"]), joined().exists())
own = Path.home().parent
found = own.rglob("*") if own.name.startswith("beatrix-lesson-") else []
print("files", [path for path in found if path.is_file() and b"PRIVATE" in path.read_bytes()])
"""


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class in which the robot bea1 and the seat ana's own robot are online."""
    with ClassRouter(tmp_path_factory.mktemp("class"), seats='{ana = "Ána Ruiz", ben = "Ben"}') as made:
        folders = {name: tmp_path_factory.mktemp(name) for name in ("bea1", "ana")}
        nodes = [start_node(folder, made.path(name)) for name, folder in folders.items()]
        yield made
        for node in nodes:
            assert node.end() == 0


@pytest.fixture
def clients(router: ClassRouter) -> Iterator[dict[str, Client]]:
    """Clients of two seats and the teacher."""
    made = {name: router.client(name) for name in ("ana", "ben", "teacher")}
    yield made
    for client in made.values():
        client.close()


def test_a_seat_drives_the_robots_of_the_class_and_its_own_and_no_other(clients: dict[str, Client]) -> None:
    ana = clients["ana"]
    for name in ("bea1", "ana"):
        ready(Robot(name, "hw", client=ana)).look(yaw=5)
    assert Robot("ana", "hw", client=clients["ben"]).status().holder == "ana"
    with pytest.raises(NoAnswer, match="the router refuses this request: account ben") as denied:
        Robot("ana", "hw", client=clients["ben"]).look(yaw=0)
    assert denied.value.reason is Reason.ACCESS_DENIED
    with pytest.raises(Refused, match="ana drives this robot"):
        Robot("bea1", "hw", client=clients["ben"]).look(yaw=0)
    Robot("ana", "hw", client=clients["ben"]).stop()
    Robot("bea1", "hw", client=clients["teacher"]).look(yaw=0)


def test_an_emergency_stop_of_a_student_reaches_all_robots(
    router: ClassRouter, clients: dict[str, Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    robots = [Robot(name, "hw", client=clients["teacher"]) for name in ("bea1", "ana")]
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path("ana")))
    done = beatrix("stop", "--emergency")
    assert (done.returncode, [robot.status().fault for robot in robots]) == (0, [Fault.EMERGENCY] * 2), done
    for robot in robots:
        robot.reset()


def test_only_the_teacher_sees_the_names_of_the_pupils(
    router: ClassRouter, clients: dict[str, Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert clients["ana"].robots()
    for name, shown in (("teacher", "Ána Ruiz (ana)"), ("ben", "seats: ana, ben")):
        monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path(name)))
        assert shown in beatrix("top", "--once").stdout


def test_a_turn_lends_the_program_a_session_and_no_account(
    router: ClassRouter, clients: dict[str, Client], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = ready(Robot("bea1", "hw", client=clients["teacher"]))
    until(lambda: not robot.status().holder, "no seat drives")
    path = tmp_path / "start.py"
    path.write_text(LOOKS_FOR_ACCOUNT)
    account = router.account("ana")
    turns.take_turn(program.read(path), Settings("bea1", account.connect, "ana", account=account), "hw", 20.0)
    printed = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert printed[-3:] == ["reached 10 ana", "account None '' False", "files []"]


def test_the_teacher_simulates_all_seats_and_each_drives_only_its_own(
    router: ClassRouter, tmp_path: Path
) -> None:
    use_account(tmp_path, router.path("teacher"))
    process = Process(
        *CLI, "sim", "--seats", str(router.class_file), "--ready", folder=tmp_path, traced=False
    )
    try:
        process.expect_all("ready beatrix/ana/sim/", "ready beatrix/ben/sim/")
        own, of_another = (router.robot(name, "sim", "ana") for name in ("ana", "ben"))
        assert own.look(yaw=5).result().result
        with pytest.raises(NoAnswer):
            of_another.look(yaw=5)
        assert of_another.status().robot == "ben", "every seat may watch"
    finally:
        assert process.end() == 0
