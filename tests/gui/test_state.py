"""The actions of intents, and the resulting views."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from golden import same
from gui_worlds import (
    BOTH,
    NOT_SIM,
    NOWHERE,
    absent,
    accept,
    arms_of,
    robot,
    sent,
    state_after,
    status,
    world,
)
from present import present

from beatrix_zenoh.client import Presence
from beatrix_zenoh.contract._generated.messages import CameraStatus, Command
from gui.console.state import intents
from gui.console.state.actions import (
    Action,
    BeginRecording,
    ChooseRobot,
    EndRecording,
    MakeReady,
    SendCommand,
    SendStop,
    StartSimulation,
    ViewRecording,
    WatchCameras,
)
from gui.console.state.intents import Choose, Jog, RunCommand, Tab
from gui.console.state.state import State
from gui.console.state.views import ButtonView, View
from gui.console.state.world import LinkPhase, RecordingProgress, Trouble, World
from gui.console.texts import LANGUAGES

LOST_ROUTER = Trouble("trouble.router", "SIGKILL", "ready tcp/127.0.0.1:7447")
FULL = Trouble("trouble.recorder", "1", "The disk is full.")


def motion_buttons(view: View) -> list[ButtonView]:
    rows = [button for row in view.arms.rows for button in (row.minus, row.plus)]
    return [
        *rows,
        view.head.send,
        view.commands.home,
        view.commands.undo,
        view.poses.go,
        view.poses.play,
    ]


# -- modes -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("relative", "arm", "sign", "goal"),
    [
        (True, "short", 1, (5, 0, 0)),
        (True, "long", -1, (0, 0, -5)),
        (True, "all", 1, (5, 5, 5)),
        (False, "short", 1, (5, -20, 30)),
        (False, "middle", -1, (10, -5, 30)),
        (False, "all", -1, (-5, -5, -5)),
    ],
)
def test_plus_and_minus_turn_by_or_to_the_increment(
    relative: bool, arm: str, sign: int, goal: tuple[int, ...]
) -> None:
    now = world(robot("sim", arms=(10, -20, 30)))
    send = sent(state_after(intents.Choose("relative", value=relative)).handle(Jog(arm, sign), now))
    assert arms_of(send) == goal
    assert send.query.absolute is not relative
    assert send.sides == ("sim",)


# -- destinations ------------------------------------------------------------------------------------


def test_with_both_boxes_checked_one_motion_is_sent_with_the_lead() -> None:
    state = state_after(BOTH)
    send = sent(state.handle(Jog("all", 1), world()))
    assert (send.sides, send.lead_s) == (("sim", "hw"), 2.0)
    state.handle(intents.Choose("lead_s", 0.0), world())
    assert sent(state.handle(intents.SendHead(), world())).lead_s == 0.0
    state.handle(NOT_SIM, world())
    send = sent(state.handle(intents.SendHead(), world()))
    assert (send.sides, send.lead_s) == (("hw",), 0.0)


def test_commands_go_to_the_checked_robots_or_to_the_one_that_is_named() -> None:
    state = state_after(BOTH)
    (both,) = state.handle(RunCommand(Command.ENABLE, value=False), world())
    assert isinstance(both, SendCommand)
    assert (both.sides, both.value) == (("sim", "hw"), False)
    (one,) = state.handle(RunCommand(Command.RESET, side="sim"), world())
    assert isinstance(one, SendCommand)
    assert one.sides == ("sim",)
    assert state.handle(MakeReady("hw"), world()) == [MakeReady("hw", 3)]


def test_without_a_checked_box_motion_buttons_are_disabled_with_a_reason() -> None:
    state = state_after(NOT_SIM)
    for button in motion_buttons(state.view(world())):
        assert not button.enabled
        same("state.without a checked box motion buttons are disabled with a reason", button.tooltip)
    assert state.handle(Jog("short", 1), world()) == []
    refusal = present(state.view(world()).arms.refusal)
    assert (refusal.control, refusal.text.split(":")[0]) == (
        "short",
        "Check Simulation, Hardware or both first",
    )
    state.handle(Choose("sim", value=True), world())
    assert state.view(world()).arms.refusal is None


@pytest.mark.parametrize(
    ("now", "text"),
    [
        (world(phase=LinkPhase.NO_ROUTER), "no router answers at tcp/127.0.0.1:7447"),
        (NOWHERE, "the simulation of bea1 is not online"),
    ],
)
def test_a_request_that_cannot_be_sent_is_refused_beside_its_control(now: World, text: str) -> None:
    state = State()
    assert state.handle(intents.SendHead(), now) == []
    refusal = present(state.view(now).head.refusal)
    assert text in refusal.text
    assert refusal.alternative is None
    assert state.view(now).arms.refusal is None
    state.handle(intents.DismissRefusal(), now)
    assert state.view(now).head.refusal is None


def test_an_absolute_jog_needs_the_angles_of_the_other_arms() -> None:
    now = world(robot("sim", arms=None))
    state = state_after(intents.Choose("relative", value=False))
    assert state.handle(Jog("short", 1), now) == []
    refusal = present(state.view(now).arms.refusal)
    assert "no positions arrive" in refusal.text
    assert arms_of(sent(state.handle(Jog("all", 1), now))) == (5, 5, 5)


# -- stop --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("now", [world(), NOWHERE, world(phase=LinkPhase.NO_ROUTER)])
def test_stop_is_always_sent_to_both_robots(now: World) -> None:
    assert state_after(NOT_SIM).handle(intents.Stop(), now) == [SendStop(1)]
    assert state_after().view(now).stop.enabled


@pytest.mark.parametrize("now", [world(), NOWHERE, world(phase=LinkPhase.NO_ROUTER)])
def test_an_emergency_stop_asks_first_and_is_always_sent_to_both_robots(now: World) -> None:
    button = state_after(NOT_SIM).view(now).emergency
    assert button.enabled
    assert "fall" in button.question
    state = state_after(NOT_SIM)
    assert state.handle(button.intent, now) == [SendStop(1, emergency=True)]
    assert state.view(now).history[0].what == "emergency stop"


# -- window ------------------------------------------------------------------------------------------


EYES = frozenset((side, eye) for side in ("sim", "hw") for eye in ("left", "right"))


def test_only_visible_pictures_are_subscribed_to() -> None:
    state = State()
    assert state.handle(intents.Choose("tab", Tab.HEADS), world()) == [WatchCameras(frozenset())]
    assert state.handle(intents.Choose("tab", Tab.EYES), world()) == [WatchCameras(frozenset())]
    assert state.view(world()).choices.tab is Tab.EYES
    assert state.handle(intents.Choose("cameras", value=True), world()) == [WatchCameras(EYES)]
    watched = {(eye.side, eye.eye) for eye in state.view(world(hw=absent("hw"))).eyes if eye.watched}
    assert watched == {("sim", "left"), ("sim", "right")}
    assert state.handle(intents.Choose("cameras", value=False), world()) == [WatchCameras(frozenset())]
    assert state.handle(intents.Choose("tab", Tab.PLOTS), world()) == [WatchCameras(frozenset())]


def camera(*, connected: bool = True, streaming: bool = True, trouble: str = "") -> CameraStatus:
    return CameraStatus(
        eye="left",
        connected=connected,
        streaming=streaming,
        hz=15.0,
        width=640,
        height=480,
        source="v4l2",
        trouble=trouble,
    )


@pytest.mark.parametrize(
    ("cameras", "left"),
    [
        ((), "This robot has no camera for this eye."),
        ((camera(),), ""),
        ((camera(trouble="Coarse pictures."),), ""),
        ((camera(streaming=False),), "The window is waiting for pictures."),
        ((camera(connected=False, streaming=False),), "The camera is not connected."),
        ((camera(connected=False, streaming=False, trouble="In use."),), "In use."),
    ],
)
def test_a_missing_picture_has_a_reason(cameras: tuple[CameraStatus, ...], left: str) -> None:
    now = world(robot("sim", known=status("sim", cameras=cameras)), absent("hw"))
    state = state_after(intents.Choose("cameras", value=True))
    found = {(eye.side, eye.eye): eye.text for eye in state.view(now).eyes}
    assert found["sim", "left"].startswith(left)
    assert bool(found["sim", "left"]) is bool(left)
    assert found["hw", "left"].startswith("The hardware is not online.")
    hung = robot("hw", age_s=2.0)
    lost = replace(robot("hw"), presence=Presence.ABSENT)
    for gone, word in ((hung, "is online but sends nothing"), (lost, "is no longer online")):
        assert word in state.view(world(hw=gone)).eyes[-1].text
    assert {eye.text for eye in State().view(world()).eyes} == {"The eye cameras are off. Check Eye cameras."}


def test_the_failure_of_a_child_program_is_shown_in_banner_and_last_line() -> None:
    failed = replace(world(absent("sim"), absent("hw"), names=()), child_trouble=LOST_ROUTER)
    banner = present(State().view(failed).banner)
    same("state.the failure of a child program is shown in banner and last line 1", banner.text)
    same("state.the failure of a child program is shown in banner and last line 2", State().view(failed).last)


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_output_of_a_child_program_is_a_detail(code: str) -> None:
    failed = replace(world(absent("sim"), absent("hw"), names=()), child_trouble=LOST_ROUTER)
    state = state_after(intents.Choose("language", code))
    view = state.view(failed)
    assert view.banner is not None
    assert not {text for text in (view.banner.text, view.last) if LOST_ROUTER.detail in text}
    assert view.last_detail == LOST_ROUTER.detail


def test_a_simulation_that_another_program_started_first_is_no_failure() -> None:
    """`beatrix up` starts a crashed simulation again, so the one of the window is refused: its name is taken."""
    second = Trouble("trouble.simulation", "1", "Its output: ...")
    state, here = State(), replace(world(), child_trouble=second)
    state.handle(StartSimulation(), world(absent("sim")))
    state.follow(here)
    assert state.view(here).last == "No command yet."
    gone = replace(world(absent("sim")), child_trouble=second)
    assert "The simulation has ended" in state.view(gone).last


def test_the_failure_of_a_simulation_goes_when_one_is_online_again() -> None:
    state, gone = State(), replace(world(absent("sim")), child_trouble=LOST_ROUTER)
    here = replace(world(), child_trouble=LOST_ROUTER)
    shown = []
    for now in (here, gone, here):  # at first the window has not seen the loss
        state.follow(now)
        shown.append("SIGKILL" in state.view(now).last)
    assert shown == [False, True, False]


def test_a_recording_is_begun_ended_and_opened() -> None:
    file, state = Path("a.rrd"), State()

    def pressed(now: World) -> list[Action]:
        view = state.view(now).record
        return state.handle(view.toggle.intent, now) if view.toggle.enabled else []

    assert pressed(world()) == [BeginRecording()]
    running = world(recording=RecordingProgress(file, running=True, seconds=72.6))
    assert state.view(running).record.text == "1:12"
    assert pressed(running) == [EndRecording()]
    assert state.view(running).record.open is None
    ending = world(recording=RecordingProgress(file, running=True, seconds=72.6, ending=True))
    assert not State().view(ending).record.toggle.enabled
    assert pressed(ending) == []
    ended = world(recording=RecordingProgress(file, running=False, seconds=72.6, trouble=FULL))
    opened = present(state.view(ended).record.open)
    assert state.handle(opened.intent, ended) == [ViewRecording(file)]
    saved = world(recording=RecordingProgress(file, running=False, seconds=72.6))
    assert state.view(saved).last == "recorded: a.rrd"
    same("state.a recording is begun ended and opened", state.view(ended).last)
    state.handle(intents.Stop(), ended)
    assert state.view(ended).last == "last: stop sent, both"


def test_choosing_another_robot_selects_it_and_clears_the_undo_list() -> None:
    state = state_after(Jog("short", 1))
    accept(state, 1)
    now = world(names=("bea2", "bea1"))
    assert state.view(now).robots == ("bea1", "bea2")
    assert state.handle(ChooseRobot("bea2"), now) == [ChooseRobot("bea2")]
    assert not state.view(now).commands.undo.enabled
