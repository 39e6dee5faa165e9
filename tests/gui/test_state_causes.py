"""A refusal goes when its robots are ready again, and not before one of them was seen not to be."""

from __future__ import annotations

from typing import Any

import pytest
from gui_worlds import absent, refused, robot, state_after, status, world

from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.contract.refusals import taken_by
from gui.console.state.intents import Jog
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, World

WELL = world()


def sim(**fields: Any) -> World:
    return world(robot("sim", known=status("sim", **fields)))


CAUSES = {
    Reason.NOT_ENABLED: sim(enabled=False),
    Reason.NOT_HOLDER: sim(holder="anna"),
    Reason.FROZEN: sim(frozen=True),
    Reason.EMERGENCY: sim(fault=Fault.EMERGENCY),
    Reason.NO_SUCH_ROBOT: world(absent("sim")),
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
