"""A motion of both robots: preview, countdown, and the buttons during the lead."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from golden import same
from gui_worlds import BOTH, NOT_SIM, accept, arms_of, plan, refused, robot, sent, state_after, world
from present import present

from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.contract._generated.messages import Detail, Limit, LimitInfo, PoseQuery, Reason
from beatrix_zenoh.motion.gear import Gear
from gui.console.state import intents
from gui.console.state.actions import Abort, Outcome, Send, SendNow, SendStop
from gui.console.state.intents import Choose, HeadOrientation, Jog
from gui.console.state.state import State
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


# -- dragging the head -------------------------------------------------------------------------------

LIVE = intents.Choose("live", value=True)
LIMITS = LimitInfo(
    tilt_max=math.radians(20),
    gap_min=0.5,
    yaw_max=math.pi,
    speed_default=0.5,
    speed_max=1.5,
    acceleration=3.0,
)


def head_of(send: Send) -> tuple[float, ...]:
    query = send.query
    assert isinstance(query, PoseQuery)
    return tuple(round(math.degrees(angle), 1) + 0.0 for angle in (query.yaw, query.pitch, query.roll))


def test_send_on_release_sends_the_target_to_the_checked_robots() -> None:
    state = state_after(intents.Choose("send_on_release", value=True), intents.Choose("hw", value=True))
    assert state.handle(intents.ReleaseHead(), world()) == []  # a click without a drag has no target
    state.handle(intents.AimHead(20.0, 5.0, 0.0), world())
    send = sent(state.handle(intents.ReleaseHead(), world()))
    assert send.sides == ("sim", "hw")
    assert head_of(send) == (20.0, 5.0, 0.0)


@pytest.mark.parametrize("sides", [("sim",), ("hw",), ("sim", "hw"), ()])
def test_live_moves_the_simulation_alone_in_one_row_of_the_history(sides: tuple[str, ...]) -> None:
    state = state_after(LIVE, *(intents.Choose(side, value=side in sides) for side in ("sim", "hw")))
    rows = set()
    for yaw in (5.0, 10.0, 15.0):
        state.handle(intents.AimHead(yaw, 0.0, 0.0), world())
        send = sent(state.handle(intents.LiveHead(), world()))
        assert send.sides == ("sim",)
        assert head_of(send) == (yaw, 0.0, 0.0)
        rows.add(send.row)
        accept(state, send.row)
    assert state.handle(intents.ReleaseHead(), world()) == []
    (row,) = state.view(world()).history
    assert rows == {row.row}
    assert "15" in state.view(world()).code.text  # repeating it goes to where the drag has ended
    for intent in (intents.GrabHead(), intents.AimHead(20.0, 0.0, 0.0)):
        state.handle(intent, world())
    assert sent(state.handle(intents.LiveHead(), world())).row not in rows  # the next drag


@pytest.mark.parametrize(
    ("sides", "pitch", "sends"),
    [(("sim",), 5.0, False), (("sim",), 40.0, True), (("hw",), 5.0, True), (("sim", "hw"), 5.0, True)],
)
def test_in_the_simple_window_a_drag_moves_the_simulation_and_its_end_sends(
    sides: tuple[str, ...], pitch: float, sends: bool
) -> None:
    """The simulation is there already, unless the target is too far, which the refusal then explains."""
    checks = (intents.Choose(side, value=side in sides) for side in ("sim", "hw"))
    state = state_after(intents.Choose("simple", value=True), *checks)
    for intent in (intents.GrabHead(), intents.AimHead(0.0, pitch, 0.0)):
        assert state.handle(intent, world()) == []
    live = state.handle(intents.LiveHead(), world())
    assert [send.sides for send in live if isinstance(send, Send)] == [("sim",)] * ("sim" in sides)
    released = state.handle(intents.ReleaseHead(), world())
    assert [send.sides for send in released if isinstance(send, Send)] == [sides] * sends
    assert all(state.view(world()).head.side(side) is not None for side in sides)
    assert state.view(world()).head.hw is None or "hw" in sides, "no ghost hides the face"


@pytest.mark.parametrize("stop", [intents.Stop(), intents.EmergencyStop()])
def test_stop_ends_live_until_the_next_drag(stop: intents.Intent) -> None:
    state = state_after(LIVE, intents.AimHead(5.0, 0.0, 0.0))
    sent(state.handle(intents.LiveHead(), world()))
    assert any(isinstance(action, SendStop) for action in state.handle(stop, world()))
    state.handle(intents.AimHead(10.0, 0.0, 0.0), world())
    assert state.handle(intents.LiveHead(), world()) == []
    for intent in (intents.ReleaseHead(), intents.GrabHead()):
        state.handle(intent, world())
    state.handle(intents.AimHead(12.0, 0.0, 0.0), world())
    assert head_of(sent(state.handle(intents.LiveHead(), world()))) == (12.0, 0.0, 0.0)


@pytest.mark.parametrize("live", [True, False])
def test_a_release_after_stop_sends_nothing(live: bool) -> None:
    state = state_after(
        intents.Choose("live", value=live),
        intents.Choose("send_on_release", value=True),
        intents.GrabHead(),
        intents.AimHead(5.0, 0.0, 0.0),
        intents.LiveHead(),
    )
    state.handle(intents.Stop(), world())
    assert state.handle(intents.ReleaseHead(), world()) == []
    for intent in (intents.GrabHead(), intents.AimHead(6.0, 0.0, 0.0)):
        state.handle(intent, world())
    assert head_of(sent(state.handle(intents.ReleaseHead(), world()))) == (6.0, 0.0, 0.0)


def test_live_stays_at_the_border_beyond_which_the_robot_would_refuse() -> None:
    now = world(limits=LIMITS)
    state = state_after(LIVE, intents.AimHead(0.0, 30.0, 0.0), now=now)
    _, pitch, roll = head_of(sent(state.handle(intents.LiveHead(), now)))
    assert 19.5 <= pitch <= 20.0
    assert roll == 0.0
    view = state.view(now).head
    assert view.target == intents.HeadOrientation(0.0, 30.0, 0.0)  # shown where the user has dragged it
    assert max(view.drag.border) < 20.5


def test_a_refused_target_keeps_its_place_and_reason_until_the_user_aims_again() -> None:
    state = State()
    for intent in (intents.AimHead(10.0, 38.0, 6.0), intents.SendHead()):
        state.handle(intent, world())
    detail = Detail(limit=Limit.TILT, value=0.67, high=0.61, unit="rad", at_goal=True)
    refused(state, detail, Reason.OUT_OF_REACH)
    drag = state.view(world()).head.drag
    assert drag.refused is not None
    assert (round(drag.refused.pitch), round(drag.refused.roll)) == (38, 6)
    assert drag.reason == "too far"
    state.handle(intents.AimHead(10.0, 30.0, 6.0), world())
    assert state.view(world()).head.drag.refused is None


@pytest.mark.parametrize(
    ("reason", "ends"), [(Reason.NOT_ENABLED, True), (Reason.ARM_GAP, False), (Reason.REPLACED, False)]
)
def test_live_ends_at_a_refusal_that_the_next_target_would_meet_again(reason: Reason, ends: bool) -> None:
    state = state_after(LIVE, intents.GrabHead(), intents.AimHead(5.0, 0.0, 0.0), intents.LiveHead())
    refused(state, None, reason, "The motors are off.")
    state.handle(intents.AimHead(6.0, 0.0, 0.0), world())
    assert bool(state.handle(intents.LiveHead(), world())) is not ends
    assert (state.view(world()).head.refusal is not None) is ends  # it stays while the user drags on
    for intent in (intents.ReleaseHead(), intents.GrabHead(), intents.AimHead(7.0, 0.0, 0.0)):
        state.handle(intent, world())
    assert state.view(world()).head.refusal is None
    assert sent(state.handle(intents.LiveHead(), world())).sides == ("sim",)
