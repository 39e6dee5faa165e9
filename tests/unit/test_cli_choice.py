"""Which robot a verb is about, when there is more than one answer."""

from __future__ import annotations

import pytest

from beatrix_zenoh import NoAnswer, Refused, names
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.line import Where, choose, named, only_one
from beatrix_zenoh.cli.options import Which
from beatrix_zenoh.settings import Settings

SIM, HW, OTHER = ("bea", "sim"), ("bea", "hw"), ("bob", "hw")
ENDPOINT = "tcp/127.0.0.1:7447"


@pytest.mark.parametrize(
    ("which", "present", "twins"),
    [
        (None, [SIM, HW], ("sim",)),
        (None, [SIM], ("sim",)),
        (None, [HW, OTHER], ("hw",)),
        (None, [], ("sim",)),
        (Which.HW, [SIM], ("hw",)),
        (Which.BOTH, [HW, SIM], ("sim", "hw")),
    ],
)
def test_simulation_is_chosen_unless_only_the_hardware_is_there_or_asked_for(
    which: Which | None, present: list[tuple[str, str]], twins: tuple[str, ...]
) -> None:
    assert choose("bea", which, present, ENDPOINT) == twins


def test_both_needs_both() -> None:
    with pytest.raises(NoAnswer, match=r"bea \(hw\) not on line"):
        choose("bea", Which.BOTH, [SIM, OTHER], ENDPOINT)


def test_only_robot_on_line_is_found_by_name_not_by_twin() -> None:
    assert only_one([SIM, HW], ENDPOINT) == "bea"


def test_several_robots_are_listed() -> None:
    with pytest.raises(Refused, match="bea, bob"):
        only_one([OTHER, SIM], ENDPOINT)


def test_nobody_on_line_is_said_with_what_to_do() -> None:
    with pytest.raises(NoAnswer, match="beatrix sim") as silence:
        only_one([], ENDPOINT)
    assert silence.value.reason is Reason.NO_ANSWER


@pytest.mark.parametrize(
    ("flag", "environment", "robot", "expected"),
    [
        ("bea", None, "bea", True),
        (None, "bea", "bea", True),
        (None, None, "from-the-file", True),
        (None, None, names.default_robot(), False),
    ],
)
def test_a_robot_is_named_by_flag_environment_or_file(
    monkeypatch: pytest.MonkeyPatch, flag: str | None, environment: str | None, robot: str, *, expected: bool
) -> None:
    if environment:
        monkeypatch.setenv("BEATRIX_ROBOT", environment)
    assert named(Where(flag, None, None), Settings(robot, ENDPOINT, "ana")) is expected
