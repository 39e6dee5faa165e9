"""Dragging the head: what is sent while the user drags, at the release, and after STOP."""

from __future__ import annotations

import math

import pytest
from gui_worlds import accept, refused, sent, state_after, world

from beatrix_zenoh.contract._generated.messages import Detail, Limit, LimitInfo, PoseQuery, Reason
from gui.console.state import intents
from gui.console.state.actions import Send, SendStop
from gui.console.state.state import State

LIVE = intents.Choose("live", value=True)
LIMITS = LimitInfo(
    tilt_max=math.radians(20),
    gap_min=math.radians(30),
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
    assert "15" in row.python  # repeating it goes to where the drag has ended
    for intent in (intents.GrabHead(), intents.AimHead(20.0, 0.0, 0.0)):
        state.handle(intent, world())
    assert sent(state.handle(intents.LiveHead(), world())).row not in rows  # the next drag


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
