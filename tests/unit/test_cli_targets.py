"""The robots that a verb selects, if several are online."""

from __future__ import annotations

import pytest

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.terminal.options import Which
from beatrix_zenoh.terminal.targets import select_sides

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
