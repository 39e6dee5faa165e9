"""Programs of blocks in the state of a window: the action of a press, and what is shown of its end."""

from __future__ import annotations

import pytest
from gui_worlds import absent, accept, state_after, tilt, world

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.state import actions
from gui.console.state.actions import EndBlocks, Outcome
from gui.console.state.intents import Choose, Repeat, RunBlocks
from gui.console.state.state import State

BOTH = Choose("sim", value=True), Choose("hw", value=True), Choose("lead_s", 1.5)


def shown(state: State) -> tuple[str, str]:
    """Return the last result, and the id of its block."""
    view = state.view(world()).blocks
    return view.text, view.at


def test_a_program_goes_to_the_checked_robots_with_the_lead() -> None:
    state = state_after(*BOTH)
    assert state.handle(RunBlocks("{}"), world()) == [actions.RunBlocks(1, ("sim", "hw"), "{}", 1.5)]
    state.handle(Choose("hw", value=False), world())
    assert state.handle(Repeat(1), world()) == [actions.RunBlocks(2, ("sim",), "{}", 0.0)]
    assert state.handle(EndBlocks(), world()) == [EndBlocks()]


def test_the_buttons_and_the_present_block() -> None:
    state = state_after(Choose("sim", value=True), Choose("hw", value=False))
    resting, running = state.view(world()).blocks, state.view(world(block="a")).blocks
    assert (resting.run.enabled, resting.end.enabled, resting.runs, resting.block) == (True, False, False, "")
    assert (running.run.enabled, running.end.enabled, running.runs, running.block) == (True, True, True, "a")
    state.handle(Choose("sim", value=False), world())
    assert not state.view(world()).blocks.run.enabled


TOO_FAR = Outcome(1, "sim", accepted=False, done=True, reason=Reason.OUT_OF_REACH, detail=tilt(), block="a")
ZERO = Outcome(
    1, "sim", False, True, Reason.BAD_VALUE, key="blocks.zero", slots={"text": "By zero."}, block="b"
)
STOPPED = Outcome(1, "sim", accepted=False, done=True, reason=Reason.STOPPED, block="a")
DONE = Outcome(1, "sim", accepted=True, done=True)


@pytest.mark.parametrize(
    ("language", "outcome", "beginning", "at"),
    [
        ("en", TOO_FAR, "The head would lean 40.0°", "a"),
        ("de", TOO_FAR, "Der Kopf stünde 40,0°", "a"),
        ("en", ZERO, "By zero.", "b"),
        ("de", ZERO, "Das teilt durch null", "b"),
        ("en", STOPPED, "ended early: STOP was pressed", ""),
        ("en", DONE, "done", ""),
    ],
)
def test_the_end_of_a_program_is_shown_with_its_block(
    language: str, outcome: Outcome, beginning: str, at: str
) -> None:
    state = state_after(Choose("sim", value=True), Choose("hw", value=False), Choose("language", language))
    state.handle(RunBlocks("{}"), world())
    accept(state, 1)
    assert shown(state)[1] == ""
    state.report(outcome)
    text, block = shown(state)
    assert (text[: len(beginning)], block) == (beginning, at)


def test_a_program_for_a_robot_that_is_not_online_is_not_sent() -> None:
    state = state_after(Choose("sim", value=True), Choose("hw", value=False))
    assert state.handle(RunBlocks("{}"), world(sim=absent("sim"))) == []
    assert shown(state) == (state.choices.texts("cannot.sim", robot="bea1"), "")
