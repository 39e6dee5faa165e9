"""The robot of a program or verb that names none."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from beatrix_zenoh import NoAnswer, Refused
from beatrix_zenoh.account import Account
from beatrix_zenoh.client.session import Client, Place, chosen_name, only_name
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.settings import Settings, resolve

SIM, HW, OTHER = ("bea", "sim"), ("bea", "hw"), ("bob", "hw")
ENDPOINT = "tcp/127.0.0.1:7447"
OWN = cast("Account", SimpleNamespace(robot="own"))
HAS_NO_ROBOT = cast("Account", SimpleNamespace(robot=""))


def client(settings: Settings, *present: Place) -> Client:
    """Return a session with these robots online."""
    return cast(
        "Client",
        SimpleNamespace(
            settings=settings, robots=lambda: list(present), bus=SimpleNamespace(endpoint=ENDPOINT)
        ),
    )


@pytest.mark.parametrize(
    ("named", "account", "acts", "present", "name"),
    [
        (True, None, True, [OTHER], "given"),
        (True, OWN, True, [OTHER], "given"),
        (False, None, True, [SIM, HW], "bea"),
        (False, None, True, [("given", "sim"), OTHER], "given"),
        (False, OWN, True, [OTHER], "given"),
        (False, OWN, False, [OTHER], "bob"),
        (False, HAS_NO_ROBOT, True, [OTHER], "bob"),
    ],
)
def test_without_a_name_the_only_robot_online_is_chosen(
    named: bool,
    account: Account | None,
    acts: bool,
    present: list[Place],
    name: str,
) -> None:
    settings = Settings("given", ENDPOINT, "ana", account=account, named=named)
    assert chosen_name(client(settings, *present), acts=acts) == name


def test_several_robots_online_are_listed_in_the_error() -> None:
    with pytest.raises(Refused, match=r'bea, bob.*Robot\("bea"\).*--name bea'):
        only_name([OTHER, SIM], ENDPOINT)


def test_the_error_for_no_robot_online_suggests_starting_one() -> None:
    with pytest.raises(NoAnswer, match="beatrix sim") as error:
        only_name([], ENDPOINT)
    assert error.value.reason is Reason.NO_ANSWER


def test_argument_environment_and_file_name_the_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("BEATRIX_ROBOT", raising=False)
    assert not resolve().named
    assert resolve("bea").named
    monkeypatch.setenv("BEATRIX_ROBOT", "bea")
    assert resolve().named
    monkeypatch.delenv("BEATRIX_ROBOT")
    (tmp_path / "beatrix.toml").write_text('robot = "bea"\n')
    assert resolve().named
