"""The lease in the window: the button of each robot, notes, and the banner when a robot gets another holder."""

from __future__ import annotations

from typing import Any

import pytest
from golden import same
from gui_worlds import robot, status, world
from present import present

from beatrix_zenoh.contract._generated.messages import LeaseAction
from gui.console.state.actions import AskLease, ChooseRobot, Govern
from gui.console.state.intents import Choose, DismissNotice
from gui.console.state.state import State
from gui.console.state.views import PillView
from gui.console.state.world import World

TAKE, WAIT, GIVE_BACK = LeaseAction.TAKE, LeaseAction.WAIT, LeaseAction.GIVE_BACK


def sim_with(seat: str = "ben", **known: Any) -> World:
    """Return the world for a seat; the status of the simulation has these fields."""
    return world(robot("sim", known=status("sim", **known)), seat=seat)


def pill(now: World) -> PillView:
    return State().view(now).pills[0]


@pytest.mark.parametrize(
    ("known", "seat", "text", "action"),
    [
        ({}, "ben", "Reserve", TAKE),
        ({"holder": "ben"}, "ben", "Reserve", TAKE),
        ({"holder": "ben", "lease": 2}, "ben", "Give back", GIVE_BACK),
        ({"holder": "ana", "lease": 2}, "ben", "Wait for my turn", WAIT),
        ({"holder": "ana", "moving": True}, "ben", "Wait for my turn", WAIT),
        ({"holder": "ana", "lease": 2, "waiting": ("cleo", "ben")}, "ben", "Leave queue", GIVE_BACK),
        ({"holder": "ana", "lease": 2}, "teacher", "Take over", TAKE),
        ({"holder": "teacher", "lease": 2}, "teacher", "Give back", GIVE_BACK),
        ({"frozen": True}, "ben", "Reserve", TAKE),
    ],
)
def test_the_button_of_a_lease_sends_its_query(
    known: dict[str, Any], seat: str, text: str, action: LeaseAction
) -> None:
    now = sim_with(seat, **known)
    button = present(pill(now).lease)
    assert (button.text, button.intent) == (text, AskLease(action, "sim"))
    assert button.tooltip
    assert State().handle(button.intent, now) == [AskLease(action, "sim", 1)]


@pytest.mark.parametrize(
    ("known", "seat", "text", "notes"),
    [
        ({}, "ben", "ready", ()),
        ({"holder": "ben"}, "ben", "ready", ("you drive",)),
        ({"holder": "ben", "lease": 2, "waiting": ("ana", "cleo")}, "ben", "ready", ("yours", "waiting: 2")),
        ({"holder": "ana", "lease": 2}, "ben", "taken by ana", ()),
        ({"holder": "ana", "lease": 2, "enabled": False}, "ben", "motors off", ("taken by ana",)),
        ({"holder": "ana", "waiting": ("cleo", "ben")}, "ben", "driven by ana", ("queue: 2 of 2",)),
        ({"frozen": True, "holder": "ana"}, "ben", "frozen by the teacher", ("ana drives",)),
        ({"frozen": True}, "teacher", "frozen", ()),
        ({"limit_deg": 20.0}, "ben", "ready", ("limit 20 °/s",)),
    ],
)
def test_a_pill_shows_the_holder_and_the_settings_of_the_teacher(
    known: dict[str, Any], seat: str, text: str, notes: tuple[str, ...]
) -> None:
    found = pill(sim_with(seat, **known))
    assert (found.text, found.notes) == (text, notes)


def banner_of(state: State, now: World) -> str:
    """Return the text of the banner after the world has changed to `now`; empty without a banner."""
    state.follow(now)
    banner = state.view(now).banner
    return "" if banner is None else banner.text


def test_the_banner_of_a_new_lease_is_shown_until_it_is_dismissed() -> None:
    state = State()
    assert banner_of(state, sim_with(holder="ana", waiting=("ben",))) == ""
    mine = sim_with(holder="ben", lease=5)
    same("state leases.the banner of a new lease is shown until it is dismissed 1", banner_of(state, mine))
    assert "your turn" in banner_of(state, mine)
    state.handle(Choose("language", "de"), mine)
    same("state leases.the banner of a new lease is shown until it is dismissed 2", banner_of(state, mine))
    assert state.handle(DismissNotice(), mine) == []
    assert banner_of(state, mine) == ""


@pytest.mark.parametrize(("case", "known"), [("1", {"holder": "teacher", "lease": 6}), ("2", {})])
def test_a_lease_that_the_teacher_takes_or_ends_has_a_banner(case: str, known: dict[str, Any]) -> None:
    state = State()
    banner_of(state, sim_with(holder="ben", lease=5))
    lost = banner_of(state, sim_with(**known))
    same(f"state leases.a lease that the teacher takes or ends has a banner {case}", lost)


def test_a_lease_that_this_window_gives_back_has_no_banner() -> None:
    state, mine = State(), sim_with(holder="ben", lease=5)
    banner_of(state, mine)
    state.handle(AskLease(GIVE_BACK, "sim"), mine)
    assert banner_of(state, mine) == ""
    assert banner_of(state, sim_with(holder="cleo", lease=6)) == ""


def test_a_taken_robot_is_given_back_before_another_is_shown() -> None:
    state, mine = State(), sim_with(holder="ben", lease=5)
    assert state.handle(AskLease(TAKE, "sim"), mine) == [AskLease(TAKE, "sim", 1)]
    state.follow(mine)
    expected = [Govern(2, GIVE_BACK, (("bea1", "sim"),)), ChooseRobot("bea2")]
    assert state.handle(ChooseRobot("bea2"), mine) == expected
    assert state.handle(ChooseRobot("bea2"), mine) == [ChooseRobot("bea2")]


def test_a_frozen_robot_has_a_banner_in_the_windows_of_students() -> None:
    same(
        "state leases.a frozen robot has a banner in the windows of students",
        banner_of(State(), sim_with(frozen=True)),
    )
    assert banner_of(State(), sim_with("teacher", frozen=True)) == ""
