"""Refusals with the button for the next step, and undo."""

from __future__ import annotations

import math
from typing import Any

import pytest
from golden import same
from gui_worlds import (
    BOTH,
    absent,
    accept,
    arms_of,
    plan,
    refused,
    robot,
    sent,
    state_after,
    status,
    tilt,
    vector,
    world,
)
from present import present

from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Command,
    Detail,
    Head,
    LeaseAction,
    Limit,
    PoseQuery,
    Reason,
)
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.refusals import (
    driven_by,
    emergency_latched,
    not_calibrated,
    not_enabled,
    taken_by,
)
from gui.console.state import intents
from gui.console.state.actions import Abort, Action, AskLease, MakeReady, Outcome, Play, SendCommand
from gui.console.state.arms import HoldArm
from gui.console.state.intents import Jog
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, PlanPhase, World

# -- refusals ----------------------------------------------------------------------------------------


def test_a_refusal_is_shown_at_the_pad_and_its_alternative_is_sent() -> None:
    state = state_after(intents.AimHead(0, 40, 0), intents.SendHead())
    refused(state, tilt(head=Head(0.0, math.radians(34), 0.0), arms=vector(1, 2, 3)), Reason.OUT_OF_REACH)
    refusal = present(state.view(world()).head.refusal)
    same("state refusals.a refusal is shown at the pad and its alternative is sent", refusal.text)
    assert present(refusal.alternative).text == "Look to 0.0°/34.0°/0.0°"
    send = sent(state.handle(present(refusal.alternative).intent, world()))
    assert isinstance(send.query, PoseQuery)
    assert (send.query.pitch, send.query.speed) == (math.radians(34), math.radians(30))
    assert state.view(world()).head.refusal is None
    assert state.view(world()).head.target.pitch == pytest.approx(34)


def test_an_alternative_speed_keeps_the_motion() -> None:
    state = state_after(intents.Choose("speed", 100), Jog("long", -1))
    other = Alternative(speed=vector(90, 90, 90))
    refused(state, Detail(limit=Limit.SPEED, alternative=other), Reason.SPEED_LIMIT)
    refusal = present(state.view(world()).arms.refusal)
    assert present(refusal.alternative).text == "Use 90.0°/s"
    send = sent(state.handle(intents.TakeAlternative(), world()))
    assert (arms_of(send), send.query.speed, send.query.absolute) == ((0, 0, -5), vector(90, 90, 90), False)


@pytest.mark.parametrize(
    ("error", "text", "action"),
    [
        (not_enabled(), "Make ready", MakeReady("sim", 2)),
        (not_calibrated(), "Calibrate", SendCommand(2, Command.CALIBRATE, value=True, sides=("sim",))),
        (emergency_latched(), "Clear the stop", SendCommand(2, Command.RESET, value=True, sides=("sim",))),
        (driven_by("ana", 1.2), "Wait for my turn", AskLease(LeaseAction.WAIT, "sim", 2)),
        (taken_by("ana"), "Wait for my turn", AskLease(LeaseAction.WAIT, "sim", 2)),
        (Refused(Reason.NOT_HOLDER, detail=Detail(holder="ana", field="lease", value=float(3))), None, None),
        (Refused(Reason.FROZEN), None, None),
    ],
)
def test_a_refusal_offers_a_button_for_the_first_required_step(
    error: Refused, text: str | None, action: Action | None
) -> None:
    state = state_after(Jog("short", 1))
    refused(state, error.detail, error.reason)
    refusal = present(state.view(world()).arms.refusal)
    assert (None if refusal.alternative is None else refusal.alternative.text) == text
    if refusal.alternative is not None:
        assert state.handle(refusal.alternative.intent, world()) == [action]


def test_a_refusal_by_one_of_two_robots_names_it_in_the_chosen_language() -> None:
    state = state_after(BOTH, Jog("short", 1))
    refused(state, not_enabled().detail, Reason.NOT_ENABLED, side="hw")
    shown = present(state.view(world()).arms.refusal)
    same("state refusals.a refusal by one of two robots names it in the chosen language 1", shown.text)
    state.handle(intents.Choose("language", "de"), world())
    shown = present(state.view(world()).arms.refusal)
    same("state refusals.a refusal by one of two robots names it in the chosen language 2", shown.text)
    assert present(shown.alternative).text == "Einschalten"
    assert state.handle(present(shown.alternative).intent, world()) == [
        SendCommand(2, Command.ENABLE, value=True, sides=("hw",))
    ]


@pytest.mark.parametrize("left", [{"head": Head(0.0, math.radians(34.9), 0.0)}, {}], ids=["a way", "no way"])
def test_a_hold_that_ends_at_a_limit_says_so_although_goals_before_were_accepted(left: Any) -> None:
    state = State()
    state.handle(HoldArm("pitch", 1), world())
    accept(state, 1)
    refused(state, tilt(**left), Reason.OUT_OF_REACH)
    refusal = present(state.view(world()).head.refusal)
    assert "at most 35.0° is allowed" in refusal.text
    assert (refusal.alternative is not None) == bool(left)


def test_the_end_of_an_accepted_motion_is_no_refusal() -> None:
    state = state_after(Jog("short", 1))
    accept(state, 1)
    refused(state, Detail(presser="ben"), Reason.STOPPED)
    assert state.view(world()).arms.refusal is None


def test_a_motion_that_this_window_stops_or_aborts_is_not_a_refusal() -> None:
    for intent, result in ((intents.Stop(), "stopped"), (Abort(), "aborted by you")):
        state, now = state_after(BOTH, Jog("short", 1)), plan(PlanPhase.TRYING)
        state.handle(intent, now)
        state.report(Outcome(1, "", False, True, Reason.STOPPED, "Aborted in this window."))
        view = state.view(now)
        assert view.arms.refusal is None
        assert view.history[-1].result == result
        assert view.history[-1].on_purpose is isinstance(intent, Abort)


@pytest.mark.parametrize(
    ("reason", "german"),
    [
        (Reason.BAD_VALUE, "Das ist nicht möglich: Something is wrong."),
        (Reason.BUSY, "Zu viele Anfragen warten. Sende weniger in der Sekunde."),
    ],
)
def test_a_refusal_without_data_is_german_unless_only_its_message_explains_it(
    reason: Reason, german: str
) -> None:
    state = state_after(BOTH, Jog("short", 1))
    refused(state, None, reason, "Something is wrong.", side="")
    shown = present(state.view(world()).arms.refusal)
    assert shown.text == "Something is wrong."
    state.handle(intents.Choose("language", "de"), world())
    assert present(state.view(world()).arms.refusal).text == german


# -- undo --------------------------------------------------------------------------------------------


def test_undo_goes_back_through_accepted_motions() -> None:
    state, here = State(), world(robot("sim", arms=(10, 0, 0)))
    state.handle(Jog("short", 1), here)
    accept(state, 1)
    state.handle(Jog("short", 1), world(robot("sim", arms=(15, 0, 0))))
    accept(state, 2)
    state.handle(Jog("short", 1), world(robot("sim", arms=(20, 0, 0))))
    refused(state, None, Reason.ARM_GAP)
    assert "short 15.0°" in state.view(here).commands.buttons["undo"].tooltip
    back = sent(state.handle(intents.Undo(), here))
    assert (arms_of(back), back.query.absolute) == ((15, 0, 0), True)
    further = sent(state.handle(intents.Undo(), here))
    assert arms_of(further) == (10, 0, 0), "an undo that is not answered yet is not sent twice"
    accept(state, back.row)
    accept(state, further.row)
    assert not state.view(here).commands.buttons["undo"].enabled
    assert state.handle(intents.Undo(), here) == []


def test_undo_moves_no_robot_that_did_not_make_the_motion() -> None:
    state, start = state_after(BOTH), world(robot("sim", arms=(10, 0, 0)), robot("hw"))
    state.handle(Jog("short", 1), world())
    accept(state, 1)
    state.handle(intents.Choose("hw", value=False), start)
    state.handle(Play(0, (), gesture="yes"), start)
    accept(state, 2)
    state.handle(BOTH, start)
    assert state.view(start).commands.buttons["undo"].tooltip.startswith("Simulation: ")
    back = sent(state.handle(intents.Undo(), start))
    assert (back.sides, arms_of(back)) == (("sim",), (10, 0, 0))
    state.handle(intents.Choose("sim", value=False), start)
    back = sent(state.handle(intents.Undo(), start))
    assert (back.sides, arms_of(back)) == (("hw",), (0, 0, 0))
    assert not state.view(start).commands.buttons["undo"].enabled
    state.handle(intents.Choose("sim", value=True), start)
    back = sent(state.handle(intents.Undo(), start))
    assert back.sides == ("sim",), "the hardware has gone back already"


def test_undo_of_a_motion_of_both_goes_to_the_pose_of_the_hardware() -> None:
    state, apart = state_after(BOTH), world(robot("sim", arms=(20, 10, 0)), robot("hw", arms=(1, 2, 3)))
    state.handle(intents.RunCommand(Command.HOME), apart)
    accept(state, 1)
    back = sent(state.handle(intents.Undo(), world()))
    assert (back.sides, arms_of(back), back.lead_s) == (("sim", "hw"), (1, 2, 3), 2.0)


# -- the end of a refusal ----------------------------------------------------------------------------

WELL = world()


def sim(**fields: Any) -> World:
    return world(robot("sim", known=status("sim", **fields)))


CAUSES = {
    Reason.NOT_ENABLED: sim(enabled=False),
    Reason.NOT_HOLDER: sim(holder="anna"),
    Reason.NODE_LOST: world(robot("sim", age_s=3.0)),
    Reason.NO_ROUTER: world(phase=LinkPhase.NO_ROUTER),
}


@pytest.mark.parametrize("reason", CAUSES)
def test_a_refusal_goes_with_its_cause(reason: Reason) -> None:
    state = state_after(Jog("short", 1))
    refused(state, taken_by("anna").detail if reason is Reason.NOT_HOLDER else None, reason)
    for now, shown in ((WELL, True), (CAUSES[reason], True), (WELL, False)):
        state.follow(now)
        assert (state.view(now).arms.refusal is not None) is shown


@pytest.mark.parametrize("now", [world(absent("sim")), world(phase=LinkPhase.REFUSED)])
def test_a_refusal_of_the_window_itself_goes_with_its_cause(now: World) -> None:
    state = State()
    assert state.handle(Jog("short", 1), now) == []
    for then, shown in ((now, True), (WELL, False)):
        state.follow(then)
        assert (state.view(then).arms.refusal is not None) is shown
