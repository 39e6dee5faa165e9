"""Settings and the names in them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import NoAnswer, Refused
from beatrix_zenoh.account import Account
from beatrix_zenoh.client.session import Client, Place, chosen_name, only_name
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, Settings, resolve
from beatrix_zenoh.terminal.options import Which
from beatrix_zenoh.terminal.targets import select_sides


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_an_argument_overrides_the_environment_which_overrides_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert (resolve().connect, resolve().named, resolve("bea").named) == (DEFAULT_ENDPOINT, False, True)
    (tmp_path / "beatrix.toml").write_text('robot = "file"\nconnect = "tcp/1.2.3.4:1"\nwho = "seat1"\n')
    assert (resolve().robot, resolve().named) == ("file", True)
    monkeypatch.setenv("BEATRIX_ROBOT", "environment")
    assert (resolve().robot, resolve().named) == ("environment", True)
    assert resolve("argument").robot == "argument"
    assert (resolve().connect, resolve().who) == ("tcp/1.2.3.4:1", "seat1")


def test_sensors_are_read_from_file_or_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert (resolve().cameras, resolve().microphones) == ((), "")
    (tmp_path / "beatrix.toml").write_text(
        'camera_left = "pattern"\ncamera_right = "/dev/v4l/by-path/a"\nmicrophones = "USB Audio"\n'
    )
    assert resolve().cameras == ("left=pattern", "right=/dev/v4l/by-path/a")
    assert resolve().microphones == "USB Audio"
    monkeypatch.setenv("BEATRIX_CAMERA_LEFT", "file:pictures")
    monkeypatch.setenv("BEATRIX_MICROPHONES", "tone")
    assert (resolve().cameras[0], resolve().microphones) == ("left=file:pictures", "tone")


@pytest.mark.parametrize("text", ["robot = 3\n", 'colour = "red"\n', "robot = \n"])
def test_an_invalid_file_raises_an_error_with_its_path(tmp_path: Path, text: str) -> None:
    (tmp_path / "beatrix.toml").write_text(text)
    with pytest.raises(Refused, match=r"beatrix\.toml"):
        resolve()


@pytest.mark.parametrize("name", ["", "Bea 1", "a/b", "*", "@x", "x" * 33, "ä"])
def test_an_invalid_name_is_refused_with_a_valid_example(name: str) -> None:
    with pytest.raises(Refused, match="for example") as refusal:
        names.check_name(name)
    assert names.PATTERN.fullmatch(refusal.value.message.split("'")[-2])


@given(st.text())
def test_tidy_always_returns_a_valid_name(text: str) -> None:
    assert names.check_name(names.tidy(text))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Zoë", "zoe"),
        ("Jürgen Groß", "jurgen-gross"),
        ("Søren", "soren"),
        ("Łukasz", "lukasz"),
        ("Æthelred", "aethelred"),
        ("李", "beatrix"),
    ],
)
def test_names_in_latin_letters_lose_their_accents(text: str, name: str) -> None:
    assert names.tidy(text) == name


# -- the robot of a program or verb that names none ------------------------------------------------


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


# -- the robots that a verb selects, if several are online -----------------------------------------


@pytest.mark.parametrize(
    ("which", "present", "sides"),
    [
        (None, [SIM, HW], ("sim",)),
        (None, [SIM], ("sim",)),
        (None, [HW, OTHER], ("hw",)),
        (None, [], ("sim",)),
        (Which.HW, [SIM], ("hw",)),
        (Which.BOTH, [HW, SIM], ("sim", "hw")),
    ],
)
def test_the_simulation_is_selected_unless_only_the_hardware_is_online_or_requested(
    which: Which | None, present: list[tuple[str, str]], sides: tuple[str, ...]
) -> None:
    assert select_sides("bea", which, present, ENDPOINT) == sides


def test_on_both_needs_simulation_and_hardware_online() -> None:
    with pytest.raises(NoAnswer, match=rf"Not online at {ENDPOINT}: bea \(hw\)\."):
        select_sides("bea", Which.BOTH, [SIM, OTHER], ENDPOINT)
