"""The first run: each step and mission notices when it is done, and only then."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from gui_worlds import absent, positions, refused, robot, status, world

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.state.actions import Abort, Action, Outcome, Send, SendNow, SendStop
from gui.console.state.intents import AimHead, Choose, Intent, SendHead, Stop
from gui.console.state.missions import MISSIONS, STEPS, TASKS, CloseGuide, SkipTask
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.console.state.world import PlanPhase, PlanProgress, World

WELL = world()


def begun(task: str, **saved: Any) -> State:
    """Return a state in which a task is the present one."""
    return State(Saved(guided=TASKS.index(task), **saved))


def text(state: State, now: World = WELL) -> str:
    guide = state.view(now).guide
    return "" if guide is None else guide.text


def ended(state: State, action: Action, reason: Reason = Reason.OK) -> None:
    """Report that each robot of a request has carried it out, or why not."""
    assert isinstance(action, Send | SendStop)
    for side in ("sim",) if isinstance(action, SendStop) else action.sides:
        state.report(Outcome(action.row, side, accepted=reason is Reason.OK, done=True, reason=reason))


def turned(yaw: float, now_s: float) -> World:
    head = replace(robot("sim"), positions=positions(yaw=yaw))
    return replace(world(head, absent("hw")), now_s=now_s)


def test_the_steps_follow_what_really_happened() -> None:
    state = State()
    off = world(robot("sim", known=status("sim", enabled=False)), absent("hw"))
    state.follow(off)
    assert text(state, off).startswith("Step 1 of 4")
    state.follow(WELL)
    assert "Step 2 of 4" in text(state)
    state.follow(WELL)
    assert "Step 2 of 4" in text(state), "nothing was dragged"
    state.handle(AimHead(20.0, 5.0, 0.0), WELL)
    state.follow(WELL)
    assert "Step 3 of 4" in text(state)
    (send,) = state.handle(SendHead(), WELL)
    state.follow(WELL)
    assert "Step 3 of 4" in text(state), "the press alone is not the motion"
    ended(state, send)
    state.follow(WELL)
    assert "Step 4 of 4" in text(state)
    (stop,) = state.handle(Stop(), WELL)
    ended(state, stop)
    state.follow(WELL)
    assert text(state).startswith("✓ Well done. Mission 1 of 3")
    assert state.saved.guided == len(STEPS)


@pytest.mark.parametrize(("yaws", "done"), [((0, 15, -15, 15), True), ((0, 15, 0, 4, 0, 4), False)])
def test_a_head_says_no_by_turning_from_side_to_side(yaws: tuple[float, ...], done: bool) -> None:
    state = begun("no")
    for number, yaw in enumerate(yaws):
        state.follow(replace(turned(yaw, float(number)), playing="no"))
    assert "Mission 1" in text(state), "a gesture is no solution"
    for number, yaw in enumerate(yaws):
        state.follow(turned(yaw, float(number)))
    assert ("Mission 2" in text(state)) is done


def test_the_edge_is_found_by_a_refusal_because_of_the_place() -> None:
    for reason, done in ((Reason.NOT_ENABLED, False), (Reason.OUT_OF_REACH, True)):
        state = begun("edge")
        state.handle(AimHead(0.0, 60.0, 0.0), WELL)
        state.handle(SendHead(), WELL)
        refused(state, None, reason)
        state.follow(WELL)
        assert ("Mission 3" in text(state)) is done


@pytest.mark.parametrize(
    ("intent", "left_s", "done"),
    [
        (Abort(), 1.4, True),
        (SendNow(), 1.4, True),
        (Abort(), 0.1, False),
        (Choose("lead_s", 1.0), 1.4, False),
    ],
)
def test_the_lead_is_beaten_while_the_hardware_waits(intent: Intent, left_s: float, done: bool) -> None:
    state = begun("lead")
    leading = replace(WELL, plan=PlanProgress(PlanPhase.LEADING, lead_s=2.0, countdown_s=left_s))
    state.follow(leading)
    assert "Mission 3" in text(state)
    state.handle(intent, leading)
    state.follow(WELL)
    assert ("Mission 3" not in text(state)) is done


def test_the_first_run_is_skipped_step_by_step_or_closed_for_good() -> None:
    state = State()
    for number in range(1, len(TASKS) + 1):
        state.handle(SkipTask(), WELL)
        assert state.saved.guided == number
    assert text(state) == ""
    state = State()
    state.handle(CloseGuide(), WELL)
    assert text(state) == ""
    assert text(State(state.saved)) == ""


def test_the_first_run_yields_to_a_banner_and_is_not_for_teachers() -> None:
    nothing = world(absent("sim"), absent("hw"))
    view = State().view(nothing)
    assert (view.banner is not None, view.guide) == (True, None)
    assert text(State(), world(seat="teacher")) == ""
    assert len(TASKS) == len(STEPS) + len(MISSIONS)
