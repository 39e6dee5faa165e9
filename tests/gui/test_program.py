"""The program of the presses: what the state puts into it."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from gui_worlds import BOTH, accept, state_after, world
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.messages import Command, Reason
from gui.console.state import intents
from gui.console.state.actions import MakeReady, Outcome, Play
from gui.console.state.intents import AimHead, Intent, Jog, PlaySequence, RunCommand, SendHead
from gui.console.state.saved import Saved, SavedPose
from gui.console.state.state import State

JOG, HOME = "twin.sim.move(5, 0, 0, relative=True, speed=30)", "twin.sim.move(0, 0, 0, speed=30)"


def ended(state: State, row: int, reason: Reason, *, accepted: bool = True) -> None:
    """Report that a request was accepted, if it was, and then ended with this reason."""
    if accepted:
        accept(state, row)
    state.report(Outcome(row, "sim", accepted=reason is Reason.OK, done=True, reason=reason))


def code(state: State) -> list[str]:
    return [line.strip() for line in state.view(world()).code.text.splitlines()]


def test_the_program_grows_line_by_line() -> None:
    state = state_after(Jog("short", 1), RunCommand(Command.HOME))
    program = state.view(world()).code.text
    assert program.endswith(f'with Twin("bea1") as twin:\n    {JOG}\n    {HOME}\n')
    state.handle(Jog("short", 1), world())
    assert state.view(world()).code.text.startswith(program)


@pytest.mark.parametrize(
    ("reason", "accepted", "line"),
    [
        (Reason.OK, True, JOG),
        (Reason.REPLACED, True, "# move by +5/0/0: replaced by a newer motion"),
        (Reason.STOPPED, True, "# move by +5/0/0: ended early: STOP was pressed"),
        (Reason.REPLACED, False, "# move by +5/0/0: replaced by a newer motion"),
    ],
)
def test_a_motion_that_did_not_happen_is_a_comment(reason: Reason, accepted: bool, line: str) -> None:
    state = state_after(Jog("short", 1))
    ended(state, 1, reason, accepted=accepted)
    assert code(state)[-2 if line.startswith("#") else -1] == line


def test_a_program_without_a_motion_is_a_program(tmp_path: Path) -> None:
    state = State()
    assert code(state)[-1] == "pass"
    state.handle(intents.Stop(), world())
    assert code(state)[-2:] == ["# stop: sent", "pass"]


THREE = (
    SavedPose("nod", 20, 0, 0, 2.0),
    SavedPose("wait", 20, 0, 0, 1.5),
    SavedPose("left", 30, 30, 30, 1.0),
)


def test_a_loop_is_played_once() -> None:
    state = State(Saved(poses=THREE))
    state.handle(intents.Choose("loop", value=True), world())
    (play,) = state.handle(PlaySequence("sim"), world())
    assert isinstance(play, Play)
    ended(state, play.row, Reason.STOPPED)
    text = state.view(world()).code.text
    assert (text.count("play(twin.sim"), text.count("ArmPose("), "while" in text) == (1, 3, False)


PRESSES = st.sampled_from(
    [
        Jog("short", 1),
        Jog("all", -1),
        BOTH,
        AimHead(10.0, -5.0, 2.0),
        SendHead(),
        RunCommand(Command.ENABLE),
        RunCommand(Command.HOME),
        MakeReady("hw"),
        intents.Stop(),
        intents.EmergencyStop(),
        intents.Undo(),
        intents.Choose("language", "de"),
        Play(0, (), gesture="mine"),
        intents.AddPose("nod"),
        intents.PlaySequence("sim"),
    ]
)
ENDS = st.sampled_from([Reason.OK, Reason.REPLACED, Reason.STOPPED, Reason.OUT_OF_REACH, None])


@given(st.lists(st.tuples(PRESSES, ENDS), max_size=12))
def test_every_history_is_a_program(history: list[tuple[Intent, Reason | None]]) -> None:
    """Its calls are those of the successful rows."""
    state, calls = State(), []
    for intent, reason in history:
        for action in state.handle(intent, world()):
            row: int = getattr(action, "row", 0)
            if row and reason is not None:
                ended(state, row, reason)
            if row and reason in (Reason.OK, None):
                calls.append(row)
    tree = ast.parse(state.view(world()).code.text)
    (block,) = [node for node in tree.body if isinstance(node, ast.With)]
    assert len(block.body) <= max(1, len({*calls})), "a row is one statement"
