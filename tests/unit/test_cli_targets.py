"""The robots that a verb selects, if several are online."""

from __future__ import annotations

import pytest

from beatrix_zenoh import NoAnswer, Refused
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.terminal.options import Which
from beatrix_zenoh.terminal.targets import Selection, is_named, only_name, select_sides

SIM, HW, OTHER = ("bea", "sim"), ("bea", "hw"), ("bob", "hw")
ENDPOINT = "tcp/127.0.0.1:7447"


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


def test_simulation_and_hardware_of_one_name_are_one_robot() -> None:
    assert only_name([SIM, HW], ENDPOINT) == "bea"


def test_several_robots_online_are_listed_in_the_error() -> None:
    with pytest.raises(Refused, match="bea, bob"):
        only_name([OTHER, SIM], ENDPOINT)


def test_the_error_for_no_robot_online_suggests_starting_one() -> None:
    with pytest.raises(NoAnswer, match="beatrix sim") as error:
        only_name([], ENDPOINT)
    assert error.value.reason is Reason.NO_ANSWER


@pytest.mark.parametrize(
    ("option", "environment", "robot", "expected"),
    [
        ("bea", None, "bea", True),
        (None, "bea", "bea", True),
        (None, None, "from-the-file", True),
        (None, None, names.default_robot(), False),
    ],
)
def test_the_robot_is_named_by_option_environment_or_file(
    monkeypatch: pytest.MonkeyPatch,
    option: str | None,
    environment: str | None,
    robot: str,
    *,
    expected: bool,
) -> None:
    if environment:
        monkeypatch.setenv("BEATRIX_ROBOT", environment)
    assert is_named(Selection(option, None, None), Settings(robot, ENDPOINT, "ana")) is expected
