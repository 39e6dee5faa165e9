"""Each cause of a missing answer has its own reason, sentence and exit code, in SDK, command line and window."""

from __future__ import annotations

import contextlib
import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
from class_router import Answering, ClassRouter, end, process_of, start_node
from robots import PATIENCE_S, Process, assert_fails, free_endpoint, until
from shell import beatrix

from beatrix_zenoh import NoAnswer, Robot
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.classroom.router_file import Part
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.settings import Settings

HW = "hw"


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class with the robot bea1 online; other robots are started by the tests."""
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        node = start_node(tmp_path_factory.mktemp("bea1"), made.path("bea1"))
        yield made
        assert node.end() == 0


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


def node_of_its_own(router: ClassRouter, stack: contextlib.ExitStack) -> Process:
    """Start a node of bea2 in a process of its own, which replies to no query."""
    script = router.folder / "node.py"
    script.write_text(NODE)
    node = Process(str(script), str(router.path("bea2")), traced=False)
    stack.callback(node.end, signal.SIGKILL)
    node.expect("ready")
    return node


def silent(router: ClassRouter, reason: Reason, stack: contextlib.ExitStack) -> tuple[Account, str, str]:
    """Return an account and a robot that does not answer it, for this reason."""
    ana = router.account("ana")
    match reason:
        case Reason.NO_ROUTER:
            return msgspec.structs.replace(ana, connect=free_endpoint().replace("tcp", "tls")), "bea1", HW
        case Reason.ACCOUNT_REFUSED:
            return router.former("ana"), "bea1", HW
        case Reason.NO_ANSWER:  # its hardware is online
            return ana, "bea1", "sim"
        case Reason.NO_SUCH_ROBOT:
            return ana, "bea7", HW
    node = node_of_its_own(router, stack)
    if reason is Reason.NODE_LOST:
        spy = stack.enter_context(contextlib.closing(router.open("bea2")))

        def kill(incoming: Incoming) -> None:
            os.kill(node.pid, signal.SIGKILL)
            incoming.finish()

        spy.serve(keys.command("bea2", HW, "*"), kill)  # the node has received the request, too
        router.settled(spy)
    return ana, "bea2", HW  # else its Python hangs, while Zenoh's threads keep its token


def enable(account: Account, name: str, side: str, timeout_s: float) -> None:
    """Send a request with the SDK."""
    with Client(Settings("", account.connect, account.name, account=account)) as client:
        client.robots()  # a node counts as lost only if this client has seen it online before
        Robot(name, side, client=client, timeout_s=timeout_s).enable()


@pytest.mark.parametrize(
    ("reason", "sentence"),
    [
        (Reason.NO_ROUTER, "No router of class 8b at"),
        (Reason.ACCOUNT_REFUSED, "refuses account ana of class 8b"),
        (Reason.NO_ANSWER, "bea1 (sim) is not online. Online: bea1 (hw). Account ana may not start it"),
        (Reason.NO_SUCH_ROBOT, "bea7 (hw) is not online, and no robot has this name. Online: bea1 (hw)"),
        (Reason.NODE_LOST, "bea2 (hw) is no longer online: its node has crashed"),
        (Reason.NODE_HANGS, "bea2 (hw) is online but did not answer within"),
    ],
)  # test_lesson.py has a request that the router denies
def test_the_sdk_raises_the_reason_of_each_missing_answer(
    router: ClassRouter, reason: Reason, sentence: str
) -> None:
    with contextlib.ExitStack() as stack:
        asked = silent(router, reason, stack)
        with pytest.raises(NoAnswer) as caught:
            enable(*asked, timeout_s=PATIENCE_S if reason is Reason.NODE_LOST else 0.5)
    assert (caught.value.reason, sentence in caught.value.message) == (reason, True), caught.value.message


def test_doctor_ends_at_a_refused_account(
    router: ClassRouter, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "ana.toml").write_text(router.former("ana").text())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MUJOCO_GL", "off")  # skips the check of OpenGL, which is not needed here
    monkeypatch.setenv("BEATRIX_ACCOUNT", "ana.toml")
    done = beatrix("doctor", "--json")
    found = {row["what"]: row for row in json.loads(done.stdout)["findings"]}
    assert (done.returncode, found["account"]["state"], "bea1 (hw)" in found) == (1, "todo", False)
    assert "beatrix join ana.toml" in found["account"]["todo"]


@pytest.mark.long("restarts a class")
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
                robot = Robot("bea1", HW, client=client)
                assert_fails(robot.enable, NoAnswer, Reason.NO_ROUTER, "and a router answers there again")
            finally:
                os.kill(other, signal.SIGCONT)
