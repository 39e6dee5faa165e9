"""Each cause of a missing answer has its own reason, sentence and exit code, in SDK, command line and window."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest
from class_router import Answering, ClassRouter, end, process_of, start_node
from robots import free_endpoint, until
from shell import beatrix

from beatrix_zenoh import NoAnswer, Robot
from beatrix_zenoh.account import Account
from beatrix_zenoh.classroom.router_file import Part
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.output import exit_code
from beatrix_zenoh.settings import Settings

HW = "hw"


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A class with the robot bea1 online."""
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        node = start_node(tmp_path_factory.mktemp("bea1"), made.path("bea1"))
        yield made
        assert node.end() == 0


def test_a_command_of_a_seat_without_its_simulation_goes_to_no_other_robot(
    router: ClassRouter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path("ana")))
    done = beatrix("enable")
    assert done.returncode == exit_code(Reason.NO_SUCH_ROBOT), done.stderr
    assert "ana (sim) is not online" in done.stderr
    assert "Online: bea1 (hw)" in done.stderr


def without_router(router: ClassRouter) -> Account:
    return msgspec.structs.replace(router.account("ana"), connect=free_endpoint().replace("tcp", "tls"))


def ana(router: ClassRouter) -> Account:
    return router.account("ana")


def ben(router: ClassRouter) -> Account:
    """The account of ben, while ana's own robot is online, to which the router refuses his requests."""
    bus = router.session("ana")
    for key in (keys.clock("ana", HW), keys.command("ana", HW, "*")):
        Answering(bus, key)
    bus.declare_token(keys.alive("ana", HW))
    router.settled(bus)
    return router.account("ben")


def former(router: ClassRouter) -> Account:
    return router.former("ana")


@pytest.mark.parametrize(
    ("account", "name", "side", "reason", "sentence"),
    [
        (without_router, "bea1", HW, Reason.NO_ROUTER, "No router of class 8b at"),
        (former, "bea1", HW, Reason.ACCOUNT_REFUSED, "refuses account ana of class 8b"),
        (
            ana,
            "bea1",
            "sim",
            Reason.NO_ANSWER,
            "bea1 (sim) is not online. Online: bea1 (hw). Account ana may not",
        ),
        (ana, "bea7", HW, Reason.NO_SUCH_ROBOT, "bea7 (hw) is not online, and no robot has this name."),
        (ben, "ana", HW, Reason.ACCESS_DENIED, "online, but the router refuses this request: account ben"),
    ],
)
def test_the_sdk_raises_the_reason_of_each_missing_answer(
    router: ClassRouter,
    account: Callable[[ClassRouter], Account],
    name: str,
    side: str,
    reason: Reason,
    sentence: str,
) -> None:
    own = account(router)
    with (
        pytest.raises(NoAnswer) as caught,
        Client(Settings("", own.connect, own.name, account=own)) as client,
    ):
        Robot(name, side, client=client, timeout_s=0.5).enable()
    assert (caught.value.reason, sentence in caught.value.message) == (reason, True), caught.value.message


def test_doctor_ends_at_a_refused_account(
    router: ClassRouter, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "ana.toml").write_text(router.former("ana").text())
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(tmp_path / "ana.toml"))
    monkeypatch.setenv("MUJOCO_GL", "off")  # skips the check of OpenGL, which is not needed here
    done = beatrix("doctor", "--json")
    found = {row["what"]: row for row in json.loads(done.stdout)["findings"]}
    assert (done.returncode, found["router"]["state"], found["account"]["state"]) == (1, "ok", "todo")
    assert "beatrix join ana.toml" in found["account"]["todo"]
    assert "bea1 (hw)" not in found


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
