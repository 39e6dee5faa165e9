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
    camera,
    robot,
    sent,
    state_after,
    status,
    world,
)
from present import present

from beatrix_zenoh.client import Presence
from beatrix_zenoh.contract._generated.messages import CameraStatus, Command, MicrophonesStatus
from gui.console.state import actions, intents
from gui.console.state.actions import (
    Action,
    ChooseRobot,
    MakeReady,
    Outcome,
    SendCommand,
    SendStop,
    Watch,
)
from gui.console.state.history import SHOWN
from gui.console.state.intents import Choose, Jog, RunCommand, Tab, TogglePage
from gui.console.state.memory import KEPT
from gui.console.state.state import State
from gui.console.state.views import ButtonView, LevelView, View
from gui.console.state.world import LinkPhase, RecordingProgress, Trouble, World

LOST_ROUTER = Trouble("trouble.router", "SIGKILL", "ready tcp/127.0.0.1:7447")
FULL = Trouble("trouble.recorder", "1", "The disk is full.")


def motion_buttons(view: View) -> list[ButtonView]:
    rows = [button for row in view.arms.rows for button in (row.minus, row.plus)]
    return [
        *rows,
        view.head.send,
        view.commands.buttons["home"],
        view.commands.buttons["undo"],
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
    assert "Check Simulation, Hardware or both" in present(state.view(world()).arms.refusal).text
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
def test_stop_is_always_sent_to_both_robots_and_an_emergency_stop_asks_first(now: World) -> None:
    state = state_after(NOT_SIM)
    view = state.view(now)
    assert view.stop.enabled
    assert view.emergency.enabled
    assert "fall" in view.emergency.question
    assert state.handle(view.stop.intent, now) == [SendStop(1)]
    assert state.handle(view.emergency.intent, now) == [SendStop(2, emergency=True)]


def test_what_a_window_keeps_is_bounded() -> None:
    state = State()
    for row in range(1, KEPT + 20):
        state.handle(Jog("short", 1), world())
        state.report(Outcome(row, "sim", accepted=True, done=True))
    memory = state._memory
    assert (len(memory.rows), len(state.view(world()).history)) == (KEPT, SHOWN)


# -- window ------------------------------------------------------------------------------------------


EYES = frozenset((side, eye) for side in ("sim", "hw") for eye in ("left", "right"))


def test_only_visible_pictures_are_subscribed_to() -> None:
    state = State()
    assert state.handle(intents.Choose("tab", Tab.EYES), world()) == []
    assert state.view(world()).choices.tab is Tab.EYES
    assert state.handle(intents.Choose("cameras", value=True), world()) == [Watch(cameras=EYES)]
    watched = {(eye.side, eye.eye) for eye in state.view(world(hw=absent("hw"))).eyes if eye.watched}
    assert watched == {("sim", "left"), ("sim", "right")}
    assert state.handle(intents.Choose("cameras", value=False), world()) == [Watch()]
    assert state.handle(intents.Choose("tab", Tab.PLOTS), world()) == []


@pytest.mark.parametrize(
    ("cameras", "left"),
    [
        ((), "This robot has no camera for this eye."),
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
    assert found["hw", "left"].startswith("No hardware of bea1 is online.")
    hung = robot("hw", age_s=2.0)
    lost = replace(robot("hw"), presence=Presence.ABSENT)
    for gone, word in ((hung, "The last positions are 2.0 s old"), (lost, "is no longer online")):
        assert word in state.view(world(hw=gone)).eyes[-1].text
    assert {eye.text for eye in State().view(world()).eyes} == {"The eye cameras are off. Check Eye cameras."}


def test_the_failure_of_a_child_program_is_shown_in_banner_and_last_line() -> None:
    failed = replace(world(absent("sim"), absent("hw"), names=()), child_trouble=LOST_ROUTER)
    banner = present(State().view(failed).banner)
    same("state.the failure of a child program is shown in banner and last line 1", banner.text)
    view = State().view(failed)
    same("state.the failure of a child program is shown in banner and last line 2", view.last)
    assert LOST_ROUTER.detail not in banner.text + view.last
    assert view.last_detail == LOST_ROUTER.detail


def test_the_failure_of_a_simulation_is_shown_until_one_is_online() -> None:
    """`beatrix up` may have started it first, so that the one of the window was refused: its name is taken."""
    state, here, gone = (State(), *(replace(now, child_trouble=LOST_ROUTER) for now in (world(), NOWHERE)))
    assert [state.view(now).last_detail != "" for now in (here, gone, here)] == [False, True, False]


def test_a_recording_is_begun_ended_and_opened() -> None:
    file, state = Path("a.rrd"), State()

    def pressed(now: World) -> list[Action]:
        view = state.view(now).record
        return state.handle(view.toggle.intent, now) if view.toggle.enabled else []

    assert pressed(world()) == [actions.BeginRecording()]
    running = world(recording=RecordingProgress(file, running=True, seconds=72.6))
    assert state.view(running).record.text == "1:12"
    assert pressed(running) == [actions.EndRecording()]
    assert state.view(running).record.open is None
    ending = world(recording=RecordingProgress(file, running=True, seconds=72.6, ending=True))
    assert not State().view(ending).record.toggle.enabled
    assert pressed(ending) == []
    ended = world(recording=RecordingProgress(file, running=False, seconds=72.6, trouble=FULL))
    opened = present(state.view(ended).record.open)
    assert state.handle(opened.intent, ended) == [actions.ViewRecording(file)]
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
    assert not state.view(now).commands.buttons["undo"].enabled


# -- microphones -------------------------------------------------------------------------------------


def microphones(*, on: bool) -> MicrophonesStatus:
    return MicrophonesStatus(connected=True, streaming=on, rate=48_000, source="device")


@pytest.mark.parametrize("on", [False, True])
def test_a_mark_shows_that_microphones_are_on(*, on: bool) -> None:
    """It comes before all other notes, which a narrow window leaves out first."""
    known = status("hw", microphones=microphones(on=on), limit_deg=20.0, holder="ana", lease=True)
    pill = State().view(world(hw=robot("hw", known=known))).pills[1]
    assert pill.notes[0].endswith("microphones on") == on
    assert len(pill.notes) == 1 + on


def test_microphones_are_on_only_while_their_levels_are_shown() -> None:
    state, both = State(), frozenset({"sim", "hw"})
    assert not state.view(world()).sound.on, "no window begins with listening"
    assert state.handle(Choose("microphones", value=True), world()) == [], "the tab is another"
    assert state.handle(Choose("tab", Tab.EYES), world()) == [Watch(microphones=both)]
    assert state.handle(Choose("tab", Tab.PLOTS), world()) == [Watch()]
    state.handle(Choose("tab", Tab.EYES), world())
    teacher = replace(world(), seat="teacher")
    assert state.handle(TogglePage(), teacher) == [Watch(class_page=True)]
    assert state.handle(TogglePage(), teacher) == [Watch(microphones=both)]
    assert state.handle(Choose("microphones", value=False), world()) == [Watch()]


def levels(now: World, *, on: bool = True) -> tuple[LevelView, ...]:
    state = State()
    state.handle(Choose("tab", Tab.EYES), now)
    state.handle(Choose("microphones", value=on), now)
    return state.view(now).sound.levels


def test_levels_are_bars_and_numbers() -> None:
    sim, hw = levels(replace(world(), levels={"sim": (-40.0, -120.0)}))
    assert (sim.left, sim.right, sim.text) == (0.5, 0.0, "left -40 dB, right -120 dB")
    assert (hw.left, hw.right, hw.text) == (0.0, 0.0, "no microphones: start the node with `--microphones`")


def test_missing_levels_have_a_reason() -> None:
    heard = world(robot("sim", known=status("sim", microphones=microphones(on=True))))
    absent = world(robot("sim", presence=Presence.ABSENT))
    for now, on, text in (
        (heard, False, "off"),
        (absent, True, "not online"),
        (heard, True, "waiting for sound"),
    ):
        assert levels(now, on=on)[0].text == text
