"""State and link with real robots: actions are carried out, and outcomes are shown."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import pytest
from copied_programs import repeat, run_copied
from gui_links import BareWindow, Linked
from robots import Stage, until

from beatrix_zenoh.contract._generated.messages import Command
from gui.console.state import intents
from gui.console.state.intents import Choose, Jog, RunCommand
from gui.console.state.views import Condition


@pytest.fixture
def linked(bea: Stage) -> Iterator[Linked]:
    """A link to both robots, whose motors are off."""
    for side in ("sim", "hw"):
        robot = bea.robot("bea", side)
        robot.stop()
        robot.disable()
    with Linked(bea.endpoint) as made:
        made.online("sim", "hw")
        yield made
    bea.close_clients()


def changed(window: BareWindow, number: int, condition: Condition) -> bool:
    """Return whether the pill of a robot shows another condition."""
    return window.view().pills[number].condition is not condition


def test_both_robots_carry_out_next_steps_motions_alternatives_and_undo(linked: Linked) -> None:
    window = BareWindow(linked)
    window.want(Choose("hw", value=True))
    for number in (0, 1):
        while (pill := window.view().pills[number]).condition is not Condition.READY:
            assert pill.next_step is not None, pill
            window.want(pill.next_step.intent)
            assert window.ends(), window.view().last
            until(partial(changed, window, number, pill.condition), "the next step was made", 5.0)
    window.want(intents.Choose("lead_s", 0.3))
    window.want(Jog("all", 1))
    assert window.ends(), window.view().last
    assert [round(angle, 1) for angle in window.commanded("hw")] == [5, 5, 5]
    window.want(intents.AimHead(0, 60, 0))
    window.want(intents.SendHead())
    assert not window.ends()
    refusal = window.view().head.refusal
    assert refusal is not None
    assert "60.0°" in refusal.text
    assert refusal.alternative is not None
    window.want(refusal.alternative.intent)
    assert window.ends(), window.view().last
    line = window.view().history[0].python
    assert line.startswith("twin.preview(")
    window.want(intents.Undo())
    assert window.ends(), window.view().last
    assert [round(angle, 1) for angle in window.commanded("hw")] == [5, 5, 5]
    run_copied(window.view().history[1].program)
    assert max(window.commanded("hw")) > 10, "the copied program does what the window did"
    window.want(Choose("sim", value=False))
    window.want(RunCommand(Command.HOME))
    assert window.ends(), window.view().last
    window.want(Jog("long", 1))
    assert window.ends(), window.view().last
    run_copied(window.view().history[0].program)
    assert [round(angle, 1) for angle in window.commanded("hw")] == [0, 0, 10]


@pytest.mark.long("two histories of random motions")
@pytest.mark.parametrize("seed", [0, 1])
def test_the_program_of_a_history_repeats_its_motions(linked: Linked, seed: int) -> None:
    pressed, repeated = repeat(linked, seed)
    assert any(pressed)
    assert repeated == pressed
