"""The first run: each step and mission notices when it is done, and only then."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from gui_worlds import absent, account, positions, refused, robot, status, world
from msgspec import structs

from beatrix_zenoh.contract._generated.messages import Head, Reason
from gui.console.state.actions import (
    Abort,
    Action,
    OpenProgram,
    Outcome,
    Play,
    RunLesson,
    Send,
    SendNow,
    SendStop,
)
from gui.console.state.intents import AimHead, Choose, Intent, SendHead, Stop
from gui.console.state.lesson_strip import OpenLesson, ShowSheet
from gui.console.state.missions import (
    MISSIONS,
    PRAISE_S,
    STEPS,
    TASKS,
    CloseGuide,
    OpenGuide,
    ShowHint,
    SkipTask,
)
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.console.state.views import StripView
from gui.console.state.world import CheckReport, LessonRun, PlanPhase, PlanProgress, ProgramProgress, World

WELL = world()
LATER = replace(WELL, now_s=WELL.now_s + 2 * PRAISE_S)
"""when the praise for what was done is not shown any more"""
Arms = tuple[float, float, float]


def begun(task: str, **saved: Any) -> State:
    """Return a state in which a task is the present one."""
    return State(Saved(guided=TASKS.index(task), **saved))


def text(state: State, now: World = LATER) -> str:
    guide = state.view(now).guide
    return "" if guide is None else guide.text


def ended(state: State, action: Action, reason: Reason = Reason.OK) -> None:
    """Report that each robot of a request has carried it out, or why not."""
    assert isinstance(action, Send | SendStop)
    for side in ("sim",) if isinstance(action, SendStop) else action.sides:
        state.report(Outcome(action.row, side, accepted=reason is Reason.OK, done=True, reason=reason))


def turned(
    yaw: float, now_s: float, pitch: float = 0, roll: float = 0, arms: Arms = (0, 0, 0), seat: str = ""
) -> World:
    angles = Head(*(math.radians(angle) for angle in (yaw, pitch, roll)))
    known = status("sim", holder=seat)
    head = replace(robot("sim", known=known), positions=structs.replace(positions(arms), head=angles))
    return replace(world(head, absent("hw")), now_s=now_s)


def test_the_steps_follow_what_really_happened() -> None:
    state = State()
    off = world(robot("sim", known=status("sim", enabled=False)), absent("hw"))
    state.follow(off)
    assert text(state, off).startswith("Step 1 of 4")
    state.follow(WELL)
    assert "Step 2 of 4" in text(state)
    state.follow(WELL)
    assert "Step 2 of 4" in text(state), "nothing was dragged"
    state.handle(AimHead(20.0, 5.0, 0.0), WELL)
    state.follow(WELL)
    assert "Step 3 of 4" in text(state)
    (send,) = state.handle(SendHead(), WELL)
    state.follow(WELL)
    assert "Step 3 of 4" in text(state), "the press alone is not the motion"
    ended(state, send)
    state.follow(WELL)
    assert "Step 4 of 4" in text(state)
    (stop,) = state.handle(Stop(), WELL)
    ended(state, stop)
    state.follow(WELL)
    assert text(state, WELL) == "✓ Well done."
    assert text(state).startswith("Mission 1 of 8")
    assert state.saved.guided == len(STEPS)


@pytest.mark.parametrize(("yaws", "done"), [((0, 15, -15, 15), True), ((0, 15, 0, 4, 0, 4), False)])
def test_a_head_says_no_by_turning_from_side_to_side(yaws: tuple[float, ...], done: bool) -> None:
    state = begun("no")
    for number, yaw in enumerate(yaws):
        now = turned(yaw, float(number))
        state.follow(replace(now, playing="no"))
        state.follow(replace(now, playing="my no"))
        state.follow(replace(now, block=""))
        state.follow(replace(now, program=ProgramProgress(running=True)))
        state.follow(turned(yaw, float(number), seat="ana"))
    assert "Mission 1" in text(state), "no gesture, program or other seat is a solution"
    for number, yaw in enumerate(yaws):
        state.follow(turned(yaw, float(number)))
    assert ("Mission 2" in text(state)) is done


def test_the_edge_is_found_by_a_refusal_because_of_the_place() -> None:
    for reason, done in ((Reason.NOT_ENABLED, False), (Reason.OUT_OF_REACH, True)):
        state = begun("edge")
        state.handle(AimHead(0.0, 60.0, 0.0), WELL)
        state.handle(SendHead(), WELL)
        refused(state, None, reason)
        state.follow(WELL)
        assert ("Mission 3" in text(state)) is done


@pytest.mark.parametrize(
    ("intent", "left_s", "done"),
    [
        (Abort(), 1.4, True),
        (SendNow(), 1.4, True),
        (Abort(), 0.1, False),
        (Choose("lead_s", 1.0), 1.4, False),
    ],
)
def test_the_lead_is_beaten_while_the_hardware_waits(intent: Intent, left_s: float, done: bool) -> None:
    state = begun("lead")
    leading = replace(WELL, plan=PlanProgress(PlanPhase.LEADING, lead_s=2.0, countdown_s=left_s))
    state.follow(leading)
    assert "Mission 3" in text(state)
    state.handle(intent, leading)
    state.follow(WELL)
    assert ("Mission 3" not in text(state)) is done


def test_a_closed_strip_opens_at_the_mission_where_it_was() -> None:
    state = begun("arm")
    state.handle(CloseGuide(), WELL)
    assert state.view(WELL).guide is None
    state.handle(OpenGuide(), WELL)
    assert text(state).startswith("Mission 5")


@pytest.mark.parametrize("hardware", [True, False])
def test_a_simulation_of_a_class_has_no_mission_about_leads(hardware: bool) -> None:
    state = begun("lead")
    state.follow(world(robot("sim"), robot("hw") if hardware else absent("hw"), account=account("ana")))
    assert ("Mission 3" in text(state)) is hardware


def test_the_first_run_is_skipped_step_by_step_or_closed_for_good() -> None:
    state = State()
    for number in range(1, len(TASKS) + 1):
        state.handle(SkipTask(), WELL)
        assert state.saved.guided == number
    assert text(state).startswith("Lesson 1: Hello, head. Let the head say yes")
    state.handle(CloseGuide(), WELL)
    assert text(state) == ""
    closed = State(state.saved)
    assert text(closed) == ""
    closed.handle(OpenGuide(), WELL)
    assert text(closed).startswith("Lesson 1")


def test_the_first_run_yields_to_a_banner_and_is_not_for_teachers() -> None:
    nothing = world(absent("sim"), absent("hw"))
    view = State().view(nothing)
    assert (view.banner is not None, view.guide) == (True, None)
    assert text(State(), world(seat="teacher")) == ""
    assert len(TASKS) == len(STEPS) + len(MISSIONS)


def around(*angles: float) -> list[World]:
    """Return the head at these places of a circle (deg), one a second."""
    return [
        turned(12 * math.cos(math.radians(one)), float(at), pitch=12 * math.sin(math.radians(one)))
        for at, one in enumerate(angles)
    ]


@pytest.mark.parametrize(
    ("task", "worlds", "done"),
    [
        ("hm", [turned(0, 0, roll=-16)], True),
        ("hm", [turned(0, 0, roll=16, pitch=9)], False),
        ("arm", [turned(0, 0, arms=(0, -21, 2))], True),
        ("arm", [turned(0, 0, arms=(21, -21, 0))], False),
        ("sleepy", [turned(0, 0), turned(0, 4.5, pitch=21)], True),
        ("sleepy", [turned(0, 0), turned(0, 1, pitch=21), turned(0, 9, pitch=22)], False),
        ("sleepy", [turned(0, 9, pitch=22)], False),
        ("circle", around(0, 90, 180, 270, 360), True),
        ("circle", around(0, -90, -180, -270, -360), True),
        ("circle", around(0, 90, 180, 90, 0), False),
        ("dance", [replace(WELL, playing="poses", playing_pose=2)], True),
        ("dance", [replace(WELL, playing="dance", playing_pose=4)], False),
    ],
)
def test_a_mission_is_noticed_from_the_robot(task: str, worlds: list[World], done: bool) -> None:
    state = begun(task)
    state.handle(ShowHint(), WELL)
    assert "\n" in text(state)
    for now in worlds:
        state.follow(now)
    assert (text(state, worlds[-1]) == "✓ Well done.") is done


@pytest.mark.parametrize(
    ("spoil", "celebrates"),
    [
        (lambda _, now: now, True),
        (lambda _, now: replace(now, now_s=99.4), False),
        (lambda _, now: replace(now, now_s=103), False),
        (lambda _, now: replace(now, playing="dance"), False),
        (lambda _, now: replace(now, sim=robot("sim", known=status("sim", holder="ana"))), False),
        (lambda _, now: replace(now, sim=robot("sim", known=status("sim", enabled=False))), False),
        (lambda state, now: (state.handle(AimHead(20, 0, 0), now), now)[1], False),
        (lambda state, now: (state.handle(Stop(), now), now)[1], False),
    ],
)
def test_the_simulated_head_celebrates_only_if_it_may(
    spoil: Callable[[State, World], World], celebrates: bool
) -> None:
    state = begun("hm")
    for action in state.handle(SendHead(), WELL):
        ended(state, action)
    state.follow(turned(0, 99, roll=16))
    actions = state.celebration(spoil(state, WELL))
    assert bool(actions) is celebrates
    if celebrates:
        (play,) = actions
        assert isinstance(play, Play)
        assert (play.gesture, play.sides) == ("yes", ("sim",))
        assert state.celebration(WELL) == [], "once"
        assert "play(" not in state.view(WELL).code.text, "the user has not pressed that"


def lesson(state: State, **run: Any) -> StripView:
    """Return the strip while these things are known about the lessons."""
    found = state.view(replace(WELL, lesson=LessonRun(**run))).guide
    assert found is not None
    return found


def test_a_lesson_is_read_started_checked_and_passed_in_the_strip() -> None:
    state = State(Saved(guided=len(TASKS)))
    assert [one.text for one in lesson(state).buttons] == ["Read", "Next", "Close"]
    assert state.handle(OpenLesson(1), WELL) == [RunLesson("start", 1, "en")]
    begun_ = {"programs": {"01-hello": "/x/start.py"}}
    assert lesson(state, **begun_).page.startswith("# Lesson 1: Hello, head")
    assert "/x/start.py" in lesson(state, **begun_).text
    state.handle(ShowSheet(""), WELL)
    assert [one.intent for one in lesson(state, **begun_).buttons[1:3]] == [
        OpenProgram(Path("/x/start.py")),
        RunLesson("watch", 1),
    ]
    not_yet = CheckReport("01-hello", "not_yet", "nods", "none", "Nod.", "lesson-1.svg")
    shown = lesson(state, **begun_, watched=1, report=not_yet, note="No hint.")
    assert shown.text.splitlines() == [
        "Lesson 1: Hello, head. ✕ Not yet. Asked: nods. Found: none. Nod.",
        "No hint.",
    ]
    assert [one.text for one in shown.buttons[:5]] == ["Picture", "Read", "Code", "End check", "Hint"]
    assert state.handle(ShowSheet("hint"), WELL) == [RunLesson("hint", 1)]
    assert lesson(state, **begun_, hint="Hint 1/3: Do it.").page == "Hint 1/3: Do it."
    refused_ = CheckReport(message="The account is the teacher's.")
    assert refused_.message in lesson(state, **begun_, report=refused_).text
    state.handle(ShowSheet("picture"), WELL)
    assert lesson(state, **begun_, report=not_yet).picture == "lesson-1.svg"
    passed = LessonRun(passed=frozenset({"01-hello"}), report=CheckReport("01-hello", "passed"))
    now = replace(WELL, lesson=passed)
    state.follow(now)
    assert [type(one) for one in state.celebration(replace(now, now_s=101))] == [Play]
    view = state.view(now).guide
    assert view is not None
    assert (view.good, view.count) == (True, "1 of 12 done")
    assert view.text.startswith("Lesson 1: Hello, head. ✓ Passed.")
    assert view.lessons[0].text == "● 1  Hello, head"


def test_a_lesson_before_the_missions_are_done_leaves_them() -> None:
    state = begun("arm")
    state.handle(OpenLesson(3), WELL)
    state.follow(turned(0, 0, arms=(21, 0, 0)))
    assert text(state).startswith("Lesson 3")
    state.handle(lesson(state).lessons[0].intent, WELL)
    assert text(state).startswith("Mission 5 of 8")


def test_another_lesson_ends_the_check() -> None:
    state = State(Saved(guided=len(TASKS)))
    now = replace(WELL, lesson=LessonRun(programs={"02-steps": "x"}, watched=1))
    assert state.handle(OpenLesson(2), now) == [RunLesson("end")]
