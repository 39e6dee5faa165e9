"""Pills: the condition of a robot and the one next step."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from golden import same
from gui_worlds import absent, account, camera, robot, status, world
from present import present

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.contract._generated.messages import Command, Fault, FollowState, LeaseAction
from gui.console.state.actions import (
    AskLease,
    ChooseRobot,
    Govern,
    LookForPorts,
    MakeReady,
    Retry,
    StartSimulation,
)
from gui.console.state.intents import Choose, DismissNotice, Intent, RunCommand
from gui.console.state.state import State
from gui.console.state.views import Condition, PillView
from gui.console.state.world import LinkPhase, World

CALIBRATE_SIM, RESET_SIM = (RunCommand(command, side="sim") for command in (Command.CALIBRATE, Command.RESET))
LEFT = Fault.ASSEMBLY_LEFT


def sim_with(**fields: Any) -> RobotState:
    return robot("sim", known=status("sim", **fields))


def pill(now: World, side: str = "sim") -> PillView:
    return next(found for found in State().view(now).pills if found.side == side)


@pytest.mark.parametrize(
    ("sim", "condition", "text", "next_step"),
    [
        (absent("sim"), Condition.ABSENT, "not online", StartSimulation()),
        (replace(absent("sim"), status=status("sim")), Condition.ABSENT, "lost", StartSimulation()),
        (robot("sim", presence=Presence.SILENT, arms=None), Condition.SILENT, "silent", None),
        (robot("sim", presence=Presence.LOST, age_s=3.0), Condition.SILENT, "silent", None),
        (robot("sim", age_s=0.41), Condition.SILENT, "silent", None),
        (replace(robot("sim"), status=None), Condition.SILENT, "silent", None),
        (sim_with(fault=Fault.EMERGENCY, enabled=False), Condition.FAULT, "emergency stop", RESET_SIM),
        (sim_with(fault=Fault.BOARD_LOST), Condition.FAULT, "board lost", None),
        (sim_with(connected=False), Condition.FAULT, "board lost", None),
        (sim_with(fault=Fault.CONTRACT_MISMATCH, connected=False), Condition.FAULT, "wrong firmware", None),
        (sim_with(fault=LEFT), Condition.FAULT, "neck put back", None),
        (sim_with(fault=LEFT, calibrated=False), Condition.FAULT, "neck put back", CALIBRATE_SIM),
        (sim_with(enabled=False, holder="ana"), Condition.DISABLED, "motors off", MakeReady("sim")),
        (sim_with(calibrated=False, holder="ana"), Condition.NOT_CALIBRATED, "not calibrated", CALIBRATE_SIM),
        (sim_with(holder="ana", moving=True), Condition.DRIVEN, "driven by ana", None),
        (sim_with(holder="ana", lease=3), Condition.DRIVEN, "taken by ana", None),
        (sim_with(frozen=True), Condition.FROZEN, "frozen by the teacher", None),
        (sim_with(following=FollowState.FOLLOWING), Condition.DRIVEN, "follows the robot", None),
        (sim_with(following=FollowState.PARTED), Condition.DRIVEN, "parted from the robot", None),
        (sim_with(holder="ben", moving=True), Condition.MOVING, "moving", None),
        (sim_with(holder="ben"), Condition.READY, "ready", None),
        (robot("sim", age_s=0.4), Condition.READY, "ready", None),
    ],
)
def test_a_pill_names_the_first_problem_and_the_next_step(
    sim: RobotState, condition: Condition, text: str, next_step: Intent | None
) -> None:
    found = pill(world(sim))
    assert (found.condition, found.text) == (condition, text)
    assert (None if found.next_step is None else found.next_step.intent) == next_step
    assert bool(found.reason) is (condition not in (Condition.READY, Condition.MOVING))


def test_the_hardware_is_enabled_before_it_is_calibrated() -> None:
    found = pill(world(hw=robot("hw", known=status("hw", enabled=False, calibrated=False))), "hw")
    assert present(found.next_step).intent == RunCommand(Command.ENABLE, side="hw")
    assert "upright" in found.reason


@pytest.mark.parametrize(
    ("phase", "text"), [(LinkPhase.CONNECTING, "connecting"), (LinkPhase.NO_ROUTER, "not online")]
)
def test_without_a_router_no_robot_is_online(phase: LinkPhase, text: str) -> None:
    found = pill(world(phase=phase))
    assert (found.condition, found.text) == (Condition.ABSENT, text)
    assert found.latency == ""
    assert bool(found.reason) is bool(found.next_step) is (phase is LinkPhase.CONNECTING), (
        "the banner has them"
    )


def test_a_window_whose_account_is_refused_offers_another_one() -> None:
    now = replace(
        world(absent("sim"), absent("hw"), phase=LinkPhase.REFUSED),
        trouble="The router refuses ana.",
        account=account("ana"),
    )
    for side in ("sim", "hw"):
        assert pill(now, side).next_step is None
    state = State()
    for language, text in (("en", "does not accept account ana"), ("de", "nimmt das Konto ana")):
        state.handle(Choose("language", language), now)
        banner = present(state.view(now).banner)
        assert text in banner.text
        assert "The router refuses ana." in banner.buttons[1].tooltip
        assert [button.intent for button in banner.buttons] == [LookForPorts(), Retry()]


def test_latency_and_details_are_shown() -> None:
    found = pill(world(sim_with(cameras=(camera(),))))
    assert found.latency == "2 ms"
    same("state pills.latency and details are shown", found.details)
    assert pill(world(), "hw").latency == ""


def test_a_latched_emergency_stop_has_a_banner_with_a_reset_for_each_robot() -> None:
    latched = status("hw", enabled=False, calibrated=False, fault=Fault.EMERGENCY)
    banner = present(State().view(world(hw=robot("hw", known=latched))).banner)
    same("state pills.a latched emergency stop has a banner with a reset for each robot", banner.text)
    assert [button.intent for button in banner.buttons] == [RunCommand(Command.RESET, side="hw")]
    both = world(robot("sim", known=latched), robot("hw", known=latched))
    assert [button.text for button in present(State().view(both).banner).buttons] == [
        "Clear it (simulation)",
        "Clear it (hardware)",
    ]


def test_without_a_robot_the_banner_offers_the_next_step() -> None:
    sim, hw = absent("sim"), absent("hw")
    assert State().view(world()).banner is None
    found = present(State().view(world(sim, hw, phase=LinkPhase.NO_ROUTER)).banner)
    assert [button.intent for button in found.buttons] == [StartSimulation(), LookForPorts(), Retry()]
    found = present(State().view(world(sim, hw, names=())).banner)
    assert [button.intent for button in found.buttons] == [StartSimulation()]
    found = present(State().view(world(sim, hw, names=("bea2",))).banner)
    assert [button.intent for button in found.buttons] == [ChooseRobot("bea2"), StartSimulation()]
    starting = State().view(world(replace(sim, status=status("sim")), hw, starting=True))
    assert present(starting.banner).buttons == ()
    assert starting.pills[0].text == "starting", "not lost"


# -- leases ------------------------------------------------------------------------------------------

TAKE, WAIT, GIVE_BACK = LeaseAction.TAKE, LeaseAction.WAIT, LeaseAction.GIVE_BACK


def with_status(seat: str = "ben", **known: Any) -> World:
    """Return the world for a seat; the status of the simulation has these fields."""
    return world(robot("sim", known=status("sim", **known)), seat=seat)


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
    now = with_status(seat, **known)
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
    found = pill(with_status(seat, **known))
    assert (found.text, found.notes) == (text, notes)


def banner_of(state: State, now: World) -> str:
    """Return the text of the banner after the world has changed to `now`; empty without a banner."""
    state.follow(now)
    banner = state.view(now).banner
    return "" if banner is None else banner.text


def test_the_banner_of_a_new_lease_is_shown_until_it_is_dismissed() -> None:
    state = State()
    assert banner_of(state, with_status(holder="ana", waiting=("ben",))) == ""
    mine = with_status(holder="ben", lease=5)
    same("state leases.the banner of a new lease is shown until it is dismissed 1", banner_of(state, mine))
    assert "your turn" in banner_of(state, mine)
    state.handle(Choose("language", "de"), mine)
    same("state leases.the banner of a new lease is shown until it is dismissed 2", banner_of(state, mine))
    assert state.handle(DismissNotice(), mine) == []
    assert banner_of(state, mine) == ""


@pytest.mark.parametrize(("case", "known"), [("1", {"holder": "teacher", "lease": 6}), ("2", {})])
def test_a_lease_that_the_teacher_takes_or_ends_has_a_banner(case: str, known: dict[str, Any]) -> None:
    state = State()
    banner_of(state, with_status(holder="ben", lease=5))
    lost = banner_of(state, with_status(**known))
    same(f"state leases.a lease that the teacher takes or ends has a banner {case}", lost)


def test_a_lease_that_this_window_gives_back_has_no_banner() -> None:
    state, mine = State(), with_status(holder="ben", lease=5)
    banner_of(state, mine)
    state.handle(AskLease(GIVE_BACK, "sim"), mine)
    assert banner_of(state, mine) == ""
    assert banner_of(state, with_status(holder="cleo", lease=6)) == ""


def test_a_taken_robot_is_given_back_before_another_is_shown() -> None:
    state, mine = State(), with_status(holder="ben", lease=5)
    assert state.handle(AskLease(TAKE, "sim"), mine) == [AskLease(TAKE, "sim", 1)]
    state.follow(mine)
    expected = [Govern(2, GIVE_BACK, (("bea1", "sim"),)), ChooseRobot("bea2")]
    assert state.handle(ChooseRobot("bea2"), mine) == expected
    assert state.handle(ChooseRobot("bea2"), mine) == [ChooseRobot("bea2")]


def test_a_frozen_robot_has_a_banner_in_the_windows_of_students() -> None:
    same(
        "state leases.a frozen robot has a banner in the windows of students",
        banner_of(State(), with_status(frozen=True)),
    )
    assert banner_of(State(), with_status("teacher", frozen=True)) == ""
