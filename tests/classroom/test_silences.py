"""Each cause of a missing answer has its own reason, sentence and exit code, in SDK, command line and window."""

from __future__ import annotations

import contextlib
import json
import os
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec
import pytest
from class_router import Answering, ClassRouter, end, process_of, start_node
from robots import PATIENCE_S, Process, free_endpoint, until
from shell import beatrix

from beatrix_zenoh import NoAnswer, Robot
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import Bus, Incoming
from beatrix_zenoh.classroom.router_file import Part
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.settings import Settings

HW = "hw"


class Lesson:
    """A class with the robot bea1 online; other robots are started by the tests."""

    def __init__(self, router: ClassRouter, folder: Path) -> None:
        self.router, self.folder = router, folder

    def file(self, account: Account) -> Path:
        """Write an account file."""
        path = self.folder / f"{account.name}.toml"
        path.write_text(account.text())
        return path


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lesson]:
    with ClassRouter(tmp_path_factory.mktemp("class")) as router:
        made = Lesson(router, tmp_path_factory.mktemp("lesson"))
        node = start_node(tmp_path_factory.mktemp("bea1"), router.path("bea1"))
        yield made
        assert node.end() == 0


@dataclass
class Case:
    """A request that gets no answer: the account that sends it, and the robot."""

    account: Account
    name: str = "bea1"
    side: str = HW


@contextlib.contextmanager
def no_router(lesson: Lesson) -> Iterator[Case]:
    nowhere = free_endpoint().replace("tcp", "tls")
    yield Case(msgspec.structs.replace(lesson.router.account("ana"), connect=nowhere))


@contextlib.contextmanager
def wrong_account(lesson: Lesson) -> Iterator[Case]:
    yield Case(lesson.router.former("ana"))


@contextlib.contextmanager
def denied(lesson: Lesson) -> Iterator[Case]:
    """A request to another seat's own robot, which the router refuses."""
    with connected(lesson, "ana") as bus:
        for key in (keys.clock("ana", HW), keys.command("ana", HW, "*")):
            Answering(bus, key)
        bus.declare_token(keys.alive("ana", HW))
        lesson.router.settled(bus)
        yield Case(lesson.router.account("ben"), "ana")


@contextlib.contextmanager
def absent(lesson: Lesson) -> Iterator[Case]:
    """A request to the absent simulation of a robot whose hardware is online."""
    yield Case(lesson.router.account("ana"), side="sim")


@contextlib.contextmanager
def unknown(lesson: Lesson) -> Iterator[Case]:
    yield Case(lesson.router.account("ana"), "bea7")


NODE = """
import sys, threading
from pathlib import Path
from beatrix_zenoh import account, bus
from beatrix_zenoh.bus import transport
from beatrix_zenoh.contract._generated import keys
transport.COMMON["transport/link/tx/lease"] = 60_000  # the router must not drop it if the computer stands still
own, kept = account.load(Path(sys.argv[1])), []
session = bus.connect(own.connect, account=own)
session.serve(keys.command("bea2", "hw", "*"), kept.append)
session.declare_token(keys.alive("bea2", "hw"))
session.tokens(keys.alive("bea2", "hw"))
print("ready", flush=True)
threading.Event().wait()
"""


@contextlib.contextmanager
def node_of_its_own(lesson: Lesson) -> Iterator[Process]:
    """A node of bea2 in a process of its own, which replies to no query."""
    script = lesson.folder / "node.py"
    script.write_text(NODE)
    node = Process(str(script), str(lesson.router.path("bea2")), traced=False)
    try:
        node.expect("ready")
        yield node
    finally:
        node.end(signal.SIGKILL)


@contextlib.contextmanager
def crashed(lesson: Lesson) -> Iterator[Case]:
    """A node that is killed after it has received the request and before it replies."""
    with connected(lesson, "bea2") as spy, node_of_its_own(lesson) as node:

        def kill(incoming: Incoming) -> None:
            os.kill(node.pid, signal.SIGKILL)
            incoming.finish()

        spy.serve(keys.command("bea2", HW, "*"), kill)
        lesson.router.settled(spy)
        yield Case(lesson.router.account("ana"), "bea2")


@contextlib.contextmanager
def hangs(lesson: Lesson) -> Iterator[Case]:
    """A node whose Python hangs, while Zenoh's threads keep its token; its process does not wait for this one."""
    with node_of_its_own(lesson):
        yield Case(lesson.router.account("ana"), "bea2")


@contextlib.contextmanager
def connected(lesson: Lesson, name: str) -> Iterator[Bus]:
    """Open a session of an account; close it at the end of the block."""
    with contextlib.closing(lesson.router.open(name)) as bus:
        yield bus


TABLE = [
    (no_router, Reason.NO_ROUTER, "No router of class 8b at"),
    (wrong_account, Reason.ACCOUNT_REFUSED, "refuses account ana of class 8b"),
    (
        denied,
        Reason.ACCESS_DENIED,
        "ana (hw) is online, but the router refuses this request: account ben",
    ),
    (
        absent,
        Reason.NO_ANSWER,
        "bea1 (sim) is not online. Online: bea1 (hw). Account ana may not start it",
    ),
    (
        unknown,
        Reason.NO_SUCH_ROBOT,
        "bea7 (hw) is not online, and no robot has this name. Online: bea1 (hw)",
    ),
    (crashed, Reason.NODE_LOST, "bea2 (hw) is no longer online: its node has crashed"),
    (hangs, Reason.NODE_HANGS, "bea2 (hw) is online but did not answer within"),
]
Provoke = Callable[[Lesson], "contextlib.AbstractContextManager[Case]"]


def enable(case: Case, timeout_s: float) -> None:
    """Send the request of a case with the SDK."""
    account = case.account
    with Client(Settings("", account.connect, account.name, account=account)) as client:
        client.robots()  # a node counts as lost only if this client has seen it online before
        Robot(case.name, case.side, client=client, timeout_s=timeout_s).enable()


@pytest.mark.parametrize(("make", "reason", "sentence"), TABLE, ids=[row[0].__name__ for row in TABLE])
def test_the_sdk_raises_the_reason_of_each_missing_answer(
    lesson: Lesson, make: Provoke, reason: Reason, sentence: str
) -> None:
    with make(lesson) as case, pytest.raises(NoAnswer) as caught:
        enable(case, PATIENCE_S if reason is Reason.NODE_LOST else 0.5)
    assert (caught.value.reason, sentence in caught.value.message) == (reason, True), caught.value.message


def test_doctor_ends_at_a_refused_account(lesson: Lesson, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(lesson.folder)
    monkeypatch.setenv("MUJOCO_GL", "off")  # skips the check of OpenGL, which is not needed here
    with wrong_account(lesson) as case:
        monkeypatch.setenv("BEATRIX_ACCOUNT", str(lesson.file(case.account)))
        done = beatrix("doctor", "--json")
    found = {row["what"]: row for row in json.loads(done.stdout)["findings"]}
    assert (done.returncode, found["account"]["state"], "bea1 (hw)" in found) == (1, "todo", False)
    assert "beatrix join ana.toml" in found["account"]["todo"]


def test_a_program_whose_router_was_lost_does_not_report_that_the_robot_was(tmp_path: Path) -> None:
    """The new router of the seats has no robots until the other one answers it."""
    with ClassRouter(tmp_path) as router:
        Answering(router.session("bea1"), keys.command("bea1", HW, "*"))
        router.session("bea1").declare_token(keys.alive("bea1", HW))
        account, other = router.account("ana"), process_of(router, Part.ROBOTS)
        with Client(Settings("bea1", account.connect, "ana", account=account)) as client:
            until(lambda: client.robots() == [("bea1", HW)], "the robot is online")
            os.kill(other, signal.SIGSTOP)
            try:
                end(router, Part.SEATS)
                until(lambda: client.losses > 0 and client.bus.connected, "a new router of the seats")
                with pytest.raises(NoAnswer, match="and a router answers there again") as caught:
                    Robot("bea1", HW, client=client).enable()
            finally:
                os.kill(other, signal.SIGCONT)
    assert caught.value.reason is Reason.NO_ROUTER
