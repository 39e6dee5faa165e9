"""A refusal goes when its cause goes, and not before the cause was seen."""

from __future__ import annotations

from typing import Any

import pytest
from gui_worlds import absent, refused, robot, state_after, status, world

from beatrix_zenoh.client import Presence
from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.contract.refusals import taken_by
from gui.console.state import intents
from gui.console.state.actions import Outcome
from gui.console.state.intents import Jog
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, World
from gui.console.texts import LANGUAGES

WELL = world(seat="ben")


def sim(**fields: Any) -> World:
    return world(robot("sim", known=status("sim", **fields)), seat="ben")


CAUSES = {
    Reason.NOT_ENABLED: sim(enabled=False),
    Reason.NOT_CALIBRATED: sim(calibrated=False),
    Reason.NOT_HOLDER: sim(holder="anna"),
    Reason.FROZEN: sim(frozen=True),
    Reason.MUTED: sim(muted=("ben",)),
    Reason.EMERGENCY: sim(fault=Fault.EMERGENCY),
    Reason.BOARD_LOST: sim(fault=Fault.BOARD_LOST),
    Reason.NO_SUCH_ROBOT: world(absent("sim"), seat="ben"),
    Reason.NODE_LOST: world(robot("sim", presence=Presence.SILENT), seat="ben"),
    Reason.NO_ROUTER: world(seat="ben", phase=LinkPhase.NO_ROUTER),
}


@pytest.mark.parametrize("reason", CAUSES)
def test_a_refusal_goes_with_its_cause(reason: Reason) -> None:
    state = state_after(Jog("short", 1))
    refused(state, taken_by("anna").detail if reason is Reason.NOT_HOLDER else None, reason)
    for now, shown in ((WELL, True), (CAUSES[reason], True), (WELL, False)):
        state.follow(now)
        assert (state.view(now).arms.refusal is not None) is shown
    assert "its cause has gone" in state.view(WELL).last


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_stop_that_did_not_arrive_is_not_called_refused_when_the_router_is_back(language: str) -> None:
    lost = CAUSES[Reason.NO_ROUTER]
    state = state_after(intents.Choose("language", language), intents.Stop(), now=lost)
    state.report(Outcome(1, "", accepted=False, done=True, reason=Reason.NO_ROUTER, message="No router."))
    told = state.view(lost).last
    for now in (lost, WELL):
        state.follow(now)
        assert state.view(now).last == told
    assert not any(word in told for word in ("refused", "abgelehnt"))


@pytest.mark.parametrize(
    "now",
    [world(absent("sim")), world(phase=LinkPhase.NO_ROUTER), world(phase=LinkPhase.REFUSED)],
    ids=["no simulation", "no router", "account"],
)
def test_a_refusal_of_the_window_itself_goes_with_its_cause(now: World) -> None:
    state = State()
    assert state.handle(Jog("short", 1), now) == []
    for then, shown in ((now, True), (world(), False)):
        state.follow(then)
        assert (state.view(then).arms.refusal is not None) is shown


def test_a_refusal_of_a_limit_stays_until_the_user_acts() -> None:
    state = state_after(Jog("short", 1))
    refused(state, None, Reason.ARM_GAP)
    for now in (sim(enabled=False), WELL, WELL):
        state.follow(now)
        assert state.view(now).arms.refusal is not None
