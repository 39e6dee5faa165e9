"""Gestures and following a face: buttons, requests, refusals and texts, without a network."""

from __future__ import annotations

import pytest
from gui_worlds import BOTH, NOT_SIM, camera, robot, state_after, status, world
from present import present

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state.actions import FOLLOW, EndProgram, Play, RunProgram
from gui.console.state.gestures import RunExample
from gui.console.state.intents import Choose, Intent
from gui.console.state.world import ProgramProgress, World


def seeing(side: str, **fields: bool | str) -> RobotState:
    """Return a robot with cameras."""
    return robot(side, known=status(side, cameras=(camera("left", **fields), camera("right", **fields))))


def faces(*, sim: bool = True, hw: bool = False, running: bool = False) -> World:
    """Return a world with robots that see, and the program that follows a face."""
    return world(
        seeing("sim") if sim else robot("sim"),
        seeing("hw") if hw else robot("hw"),
        program=ProgramProgress(FOLLOW, running),
    )


@pytest.mark.parametrize(("given", "sides", "lead_s"), [((), ("sim",), 0.0), ((BOTH,), ("sim", "hw"), 2.0)])
def test_a_press_plays_a_gesture_on_the_checked_robots(
    given: tuple[Intent, ...], sides: tuple[str, ...], lead_s: float
) -> None:
    state, gesture = state_after(*given), GESTURES[0]
    assert state.handle(Play(0, (), gesture=gesture), world()) == [
        Play(1, sides, lead_s=lead_s, gesture=gesture)
    ]
    (row,) = state.view(world()).history
    twin = "twin" if len(sides) > 1 else "twin.sim"
    assert row.what.startswith(f"gesture: {gesture.capitalize()}")
    assert f"play({twin}, load('{gesture}')" in state.view(world()).code.text


def test_without_a_checked_robot_all_buttons_give_the_reason() -> None:
    view = state_after(Choose("sim", value=False)).view(faces()).gestures
    for button in (*(button for _, button in view.gestures), view.follow, view.turn):
        assert not button.enabled
        assert "Check" in button.tooltip


@pytest.mark.parametrize(
    ("given", "now", "sides"),
    [
        ((), faces(), ("sim",)),
        ((BOTH,), faces(), ("sim", "hw")),
        ((BOTH,), faces(hw=True), ("hw", "sim")),
        ((BOTH, NOT_SIM), faces(hw=True), ("hw",)),
        ((BOTH,), world(seeing("sim", source="egl"), seeing("hw", source="pattern")), ("sim", "hw")),
        ((BOTH,), world(seeing("sim", source="egl"), seeing("hw", source="v4l2")), ("hw", "sim")),
    ],
)
def test_the_hardware_sees_if_it_moves_and_has_an_eye(
    given: tuple[Intent, ...], now: World, sides: tuple[str, ...]
) -> None:
    state = state_after(*given)
    assert state.handle(RunExample("follow"), now) == [RunProgram(1, FOLLOW, sides)]


@pytest.mark.parametrize(
    ("given", "now"),
    [
        ((), faces(sim=False)),
        ((), world(seeing("sim", connected=False))),
        ((BOTH,), faces(sim=False)),
        ((BOTH, NOT_SIM), faces()),
        ((BOTH, NOT_SIM), world(seeing("sim"), seeing("hw", source="pattern"))),
    ],
)
def test_a_robot_without_a_working_eye_follows_no_face(given: tuple[Intent, ...], now: World) -> None:
    state = state_after(*given)
    assert state.handle(RunExample("follow"), now) == []
    assert "eye" in present(state.view(now).gestures.refusal).text


def test_the_panel_says_that_the_program_runs() -> None:
    state = state_after(BOTH)
    idle = state.view(faces()).sending
    state.handle(RunExample("follow"), faces())
    sending = state.view(faces(running=True)).sending
    assert (sending.title, "STOP" in sending.text) == ("Following", True)
    assert state.view(faces()).sending == idle


def test_a_second_press_ends_the_program_even_if_no_robot_is_checked() -> None:
    state, now = state_after(Choose("sim", value=False)), faces(running=True)
    state.follow(now)
    view = state.view(now).gestures
    assert (view.running, view.follow.enabled, view.turn.text) == (FOLLOW, True, "Listen")
    assert state.handle(view.follow.intent, now) == [EndProgram()]
