"""A motion of both robots: preview, countdown, and the buttons during the lead."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from golden import same
from gui_worlds import BOTH, NOT_SIM, accept, arms_of, plan, robot, sent, state_after, world
from present import present

from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.motion.gear import Gear
from gui.console.state import intents
from gui.console.state.actions import Abort, Outcome, SendNow
from gui.console.state.intents import Choose, HeadOrientation, Jog
from gui.console.state.world import PlanPhase


@pytest.mark.parametrize("phase", [PlanPhase.LEADING, PlanPhase.SENT])
def test_what_the_preview_does_not_show_is_said(phase: PlanPhase) -> None:
    now = plan(phase)
    for known, words in (({"apart_deg": 5.7}, "stands 5.7° away"), ({"alike": False}, "different values")):
        other = replace(now, plan=replace(present(now.plan), **known))
        assert words in state_after(BOTH).view(other).sending.text


def test_the_countdown_is_shown_with_its_buttons() -> None:
    view = state_after(BOTH).view(plan(PlanPhase.LEADING, 1.4)).sending
    assert (view.title, view.countdown) == ("Possible, 1.2 s", "hardware follows in 1.4 s")
    assert view.progress == pytest.approx(0.3)
    assert [view.send_now.enabled, view.change.enabled, view.abort.enabled] == [True] * 3
    view = state_after(BOTH).view(plan(PlanPhase.TRYING)).sending
    assert [view.send_now.enabled, view.change.enabled, view.abort.enabled] == [False, True, True]
    for now in (plan(PlanPhase.SENT), world()):
        view = state_after(BOTH).view(now).sending
        assert [view.send_now.enabled, view.change.enabled] == [False] * 2
        assert view.abort.enabled is (now.plan is not None), "the button stops both robots"
        same("state lead.the countdown is shown with its buttons", view.send_now.tooltip)


def test_a_waiting_motion_is_sent_changed_or_aborted() -> None:
    path = MotionPath([0.0, 1.0], [ArmAngles(0, 0, 0)] * 2, [HeadAngles(0, 0, 0), HeadAngles(1, 2, 3)])
    waiting = plan(PlanPhase.LEADING, 1.0, path)
    state = state_after(BOTH, Jog("short", 1), intents.AimHead(-50, 0, 0))
    assert state.handle(SendNow(), waiting) == [SendNow()]
    assert state.handle(Abort(), waiting) == [Abort()]
    assert state.view(waiting).head.target.yaw == -50
    assert state.handle(intents.Change(), waiting) == [Abort()]
    head = state.view(waiting).head
    assert head.target == head.path[-1] == HeadOrientation(1, 2, 3)
    for intent in (SendNow(), intents.Change(), Abort()):
        assert state.handle(intent, world()) == []
    assert state.handle(Abort(), plan(PlanPhase.SENT)) == [Abort()]


@pytest.mark.parametrize(
    ("intent", "phase", "aborts"),
    [
        (Choose("hw", value=False), PlanPhase.TRYING, True),
        (Choose("hw", value=False), PlanPhase.LEADING, True),
        (Choose("hw", value=False), PlanPhase.SENT, False),
        (Choose("hw", value=False), None, False),
        (Choose("hw", value=True), PlanPhase.LEADING, False),
        (Choose("sim", value=False), PlanPhase.LEADING, False),
    ],
)
def test_hardware_that_is_unchecked_during_the_lead_does_not_move(
    intent: Choose, phase: PlanPhase | None, *, aborts: bool
) -> None:
    state = state_after(BOTH, Jog("short", 1))
    now = world() if phase is None else plan(phase, 1.0)
    assert state.handle(intent, now) == ([Abort()] if aborts else [])
    state.report(Outcome(1, "", accepted=False, done=True, reason=Reason.STOPPED))
    assert state.view(world()).history[0].on_purpose is aborts


def test_plus_during_the_lead_adds_to_the_goal_of_both_robots() -> None:
    state = state_after(BOTH, Jog("short", 1))
    leading = plan(PlanPhase.LEADING)
    again = sent(state.handle(Jog("long", 1), leading))
    assert again.sides == ("sim", "hw")
    assert arms_of(again) == pytest.approx((5.0, 0.0, 5.0))
    third = sent(state.handle(Jog("all", -1), leading))
    assert arms_of(third) == pytest.approx((0.0, -5.0, 0.0))
    assert third.query.absolute, "robots at different places move to one place"


@pytest.mark.parametrize("side", ["sim", "hw"])
def test_quick_presses_of_one_robot_add_up(side: str) -> None:
    state = state_after(Choose(side, value=True), *(() if side == "sim" else (NOT_SIM,)))
    turning = world(robot("sim", arms=(2, 0, 0)), robot("hw", arms=(2, 0, 0)))
    first = sent(state.handle(Jog("short", 1), world()))
    assert (first.query.absolute, arms_of(first)) == (False, (5, 0, 0))
    assert [arms_of(sent(state.handle(Jog("short", 1), turning))) for _ in range(2)] == [
        (10, 0, 0),
        (15, 0, 0),
    ]
    for row in (1, 2):
        state.report(Outcome(row, side, accepted=False, done=True, reason=Reason.REPLACED))
    accept(state, 3)
    state.report(Outcome(3, side, accepted=True, done=True))
    assert not sent(state.handle(Jog("short", 1), world(robot("sim", arms=(15, 0, 0))))).query.absolute


def test_a_press_after_stop_counts_from_where_the_arm_rests() -> None:
    state = state_after(Jog("short", 1), intents.Stop())
    again = sent(state.handle(Jog("short", 1), world(robot("sim", arms=(2, 0, 0)))))
    assert (again.query.absolute, arms_of(again)) == (False, (5, 0, 0))


@pytest.mark.parametrize(("increment", "times"), [(0.1, 30), (0.3, 10), (1.0, 5)])
def test_increments_of_both_robots_add_up_although_the_arms_stand_on_whole_microsteps(
    increment: float, times: int
) -> None:
    state, gear = state_after(BOTH, intents.Choose("increment", increment)), Gear()
    arms = (0.0, 0.0, 0.0)
    goal: tuple[float, ...] = ()
    for _ in range(times):
        goal = arms_of(
            sent(state.handle(Jog("all", 1), world(robot("sim", arms=arms), robot("hw", arms=arms))))
        )
        counted = gear.to_rad(gear.to_steps([math.radians(angle) for angle in goal]))
        short, middle, long = map(math.degrees, counted)
        arms = short, middle, long
    assert goal == pytest.approx((increment * times,) * 3, abs=1e-4)


def test_the_target_follows_the_head_until_the_user_aims() -> None:
    state = state_after()
    assert state.view(world()).head.target == state.view(world()).head.sim
    state.handle(intents.AimHead(20, 10, 5), world())
    assert state.view(world()).head.target == HeadOrientation(20, 10, 5)
    state.handle(Jog("short", 1), world())
    assert state.view(world()).head.target == state.view(world()).head.sim, "an old target is not kept"


def test_abort_just_after_the_lead_stops_both_robots() -> None:
    state = state_after(BOTH, Jog("short", 1))
    assert state.handle(Abort(), plan(PlanPhase.SENT)) == [Abort()]
    assert state.handle(Abort(), world()) == []
