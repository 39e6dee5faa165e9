"""The sequence editor: what its state decides. `test_sequence_widget.py` uses its widgets."""

from __future__ import annotations

import math

import pytest
from gui_worlds import LEFT, NOD, UP, editing, refusal_of, robot, state_after, status, world
from hypothesis import given
from hypothesis import strategies as st
from present import present

from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.refusals import not_enabled
from beatrix_zenoh.motion.trajectory import plan, shortest_s, speed_for
from gui.console.state import intents
from gui.console.state import sequence_timing as timing
from gui.console.state.actions import Outcome, Play
from gui.console.state.saved import SavedPose
from gui.console.state.sequence import POSES_MAX
from gui.console.state.sequence_timing import HOME, comfortable, timed, too_short
from gui.console.state.state import State
from gui.console.state.world import World

LIMITS = ROBOT.limits
THREE = (NOD, LEFT, UP)


def names(poses: tuple[SavedPose, ...]) -> list[str]:
    return [pose.name for pose in poses]


# -- durations --------------------------------------------------------------------------------------


@given(st.floats(0.1, 300), st.floats(1, 90), st.floats(0.05, 30))
def test_durations_are_those_of_planned_motions(way: float, speed: float, slack_s: float) -> None:
    """The planner of the nodes needs the shortest duration at top speed, and any longer one at its speed."""

    def lasts_s(top: float) -> float:
        goal, rest = math.radians(way), (0.0, 0.0, 0.0)
        acceleration = math.radians(ROBOT.limits.acceleration)
        return plan(
            rest, rest, (goal, 0.0, 0.0), (math.radians(top),) * 3, acceleration, straight=False
        ).duration

    least_s = shortest_s(way, speed, LIMITS.acceleration)
    assert lasts_s(speed) == pytest.approx(least_s, abs=1e-6)
    slower = speed_for(way, least_s + slack_s, LIMITS.acceleration)
    assert slower <= speed * (1 + 1e-9)
    assert lasts_s(slower) == pytest.approx(least_s + slack_s, rel=1e-6)


ARMS = st.floats(-90, 90).map(lambda angle: round(angle, 1))


@given(st.lists(st.tuples(ARMS, ARMS, ARMS), min_size=1, max_size=6), st.floats(1, 90))
def test_new_durations_are_possible_and_kept(places: list[tuple[float, ...]], speed: float) -> None:
    state = state_after(intents.Choose("speed", speed))
    for number, place in enumerate(places):
        state.handle(intents.AddPose(f"n{number}"), world(robot("sim", arms=place)))  # type: ignore[arg-type]
    made = state.saved.poses
    assert too_short(made, HOME, LIMITS, loop=False) == {}
    begins, here = timed(made, HOME, LIMITS), HOME
    for pose, step, following in zip(made, begins, [*begins[1:], None], strict=True):
        turned = timing.way(here, pose)
        if turned >= timing.SAME_DEG:
            needs_s = shortest_s(turned, step.speed, LIMITS.acceleration)
            assert needs_s <= pose.duration_s - timing.SETTLE_S + 1e-6
        assert following is None or following.at == pytest.approx(step.at + pose.duration_s)
        here = ArmAngles(*pose.arms)


@pytest.mark.parametrize(
    ("poses", "start", "loop", "problems"),
    [
        ((NOD, LEFT), HOME, False, {}),
        ((NOD,), None, False, {}),
        ((SavedPose("a", 90.0, 90.0, 90.0, 1.0),), HOME, False, {0: 1.6}),
        ((SavedPose("a", 90.0, 90.0, 90.0, 1.0),), ArmAngles(90.0, 90.0, 90.0), False, {}),
        ((NOD, SavedPose("a", 110.0, 90.0, 90.0, 0.5), NOD), HOME, False, {1: 1.6}),
        ((NOD, SavedPose("a", 110.0, 90.0, 90.0, 1.6)), HOME, False, {}),
        ((SavedPose("a", 0.0, 0.0, 0.0, 1.0), SavedPose("b", 90.0, 90.0, 90.0, 2.0)), HOME, True, {0: 1.6}),
    ],
)
def test_a_duration_below_what_limits_allow_is_found(
    poses: tuple[SavedPose, ...], start: ArmAngles | None, loop: bool, problems: dict[int, float]
) -> None:
    assert too_short(poses, start, LIMITS, loop=loop) == problems


def test_a_teachers_limit_makes_durations_longer() -> None:
    slow = world(robot("sim", known=status("sim", limit_deg=10.0)))
    assert timing.limits_of(slow).speed_max == pytest.approx(10.0)
    state = editing(NOD)
    assert state.view(world()).sequence.cards[0].problem == ""
    assert state.view(slow).sequence.cards[0].problem == "needs 2.2 s or more"


# -- changes ----------------------------------------------------------------------------------------

CHANGES = st.one_of(
    st.builds(intents.MovePose, st.sampled_from(["nod", "left", "up", "none"]), st.integers(-3, 9)),
    st.builds(intents.DuplicatePose, st.sampled_from(["nod", "left", "nod-2"])),
    st.builds(intents.DeletePose, st.sampled_from(["nod", "left", "up"])),
    st.builds(intents.SetDuration, st.sampled_from(["nod", "up"]), st.floats(-5, 1e9) | st.just(math.nan)),
    st.builds(
        intents.RenamePose,
        st.sampled_from(["nod", "up"]),
        st.sampled_from(["", " ", "up", "ja nein", "left"]),
    ),
    st.builds(intents.AddPose, st.sampled_from(["nod", "new"])),
    st.just(intents.AddPose()),
)


@given(st.lists(CHANGES, max_size=10))
def test_every_change_is_undone_and_names_stay_unique(given_changes: list[intents.Intent]) -> None:
    state, before = editing(*THREE), []
    for change in given_changes:
        was = state.saved.poses
        state.handle(change, world())
        now = state.saved.poses
        assert len(set(names(now))) == len(now)
        assert all(0.1 <= pose.duration_s <= 60 for pose in now)
        if now != was:
            before.append(was)
        if isinstance(change, intents.MovePose):
            assert sorted(names(now)) == sorted(names(was))
        if isinstance(change, intents.DuplicatePose) and now != was:
            at = names(was).index(change.name)
            assert now[: at + 1] == was[: at + 1]
            assert now[at + 1].arms == was[at].arms
            assert now[at + 2 :] == was[at + 1 :]
    for was in reversed(before):
        assert state.view(world()).sequence.undo.enabled
        state.handle(intents.UndoSequence(), world())
        assert state.saved.poses == was
    assert not state.view(world()).sequence.undo.enabled


def test_add_takes_the_target_of_the_pad_or_the_present_pose() -> None:
    now = world(robot("sim", arms=(10.0, -5.0, 2.5)))
    state = state_after(intents.AddPose(), now=now)
    (first,) = state.saved.poses
    assert (first.name, first.arms) == ("pose-1", (10.0, -5.0, 2.5))
    state.handle(intents.AimHead(30.0, 0.0, 0.0), now)
    state.handle(intents.AddPose(), now)
    state.handle(intents.AddPose(" bow, low "), now)
    assert names(state.saved.poses) == ["pose-1", "pose-2", "bow, low"]
    assert state.saved.poses[1].arms == pytest.approx((30.0, 30.0, 30.0))
    card = state.view(now).sequence.cards[1]
    assert present(card.head).yaw == pytest.approx(30.0)
    assert card.duration_s == comfortable(ArmAngles(*first.arms), state.saved.poses[1], 30.0, LIMITS)
    state.handle(intents.AimHead(0.0, 89.0, 0.0), now)
    state.handle(intents.AddPose(), now)
    assert len(state.saved.poses) == 3
    assert "lean" in refusal_of(state, now), "the rods do not reach it"


def test_a_sequence_has_a_largest_number_of_poses() -> None:
    state = editing(*(SavedPose(f"n{number}", *NOD.arms, 2.0) for number in range(POSES_MAX)))
    state.handle(intents.AddPose(), world())
    state.handle(intents.DuplicatePose("n1"), world())
    assert len(state.saved.poses) == POSES_MAX
    assert not state.view(world()).sequence.add.enabled


# -- playing ----------------------------------------------------------------------------------------


def played(state: State, intent: intents.Intent, now: World | None = None) -> Play:
    (action,) = state.handle(intent, now or world())
    assert isinstance(action, Play)
    return action


def test_the_hardware_follows_when_the_simulation_has_played_this_sequence() -> None:
    state = editing(NOD, LEFT)
    assert not state.view(world()).sequence.hardware.enabled
    assert state.handle(intents.PlaySequence("hw"), world()) == []
    assert "Press Play first" in refusal_of(state)
    play = played(state, intents.PlaySequence("sim"))
    assert play.sides == ("sim",)
    assert [step.at for step in play.poses] == [0.0, 2.0]
    state.report(Outcome(play.row, "sim", accepted=True, done=False))
    assert not state.view(world()).sequence.hardware.enabled
    state.report(Outcome(play.row, "sim", accepted=True, done=True))
    assert state.view(world()).sequence.hardware.enabled
    assert played(state, intents.PlaySequence("hw")).sides == ("hw",)
    state.handle(intents.SetDuration("nod", 3.0), world())
    assert not state.view(world()).sequence.hardware.enabled, "this sequence was not played yet"
    state.handle(intents.UndoSequence(), world())
    assert state.view(world()).sequence.hardware.enabled


def test_a_loop_frees_the_hardware_after_one_round() -> None:
    state = editing(NOD, LEFT, SavedPose("pause", *LEFT.arms, 1.5))
    state.handle(intents.Choose("loop", value=True), world())
    play = played(state, intents.PlaySequence("sim"))
    assert [step.at for step in play.poses] == [0.0, 2.0, 3.5]
    assert [step.at for step in play.again] == [1.5, 3.5, 5.0], "the last pose is a pause of 1.5 s"
    state.report(Outcome(play.row, "sim", accepted=True, done=False))
    assert not state.view(world()).sequence.hardware.enabled
    state.report(Outcome(play.row, "sim", accepted=True, done=False, rounds=1))
    assert state.view(world()).sequence.hardware.enabled


def test_a_pose_that_cannot_be_reached_in_its_duration_is_named() -> None:
    state = editing(NOD, SavedPose("far", 90.0, 90.0, 90.0, 0.5))
    assert [card.problem for card in state.view(world()).sequence.cards] == ["", "needs 1.6 s or more"]
    assert state.handle(intents.PlaySequence("sim"), world()) == []
    assert "'far'" in refusal_of(state)
    refusal = state.view(world()).commands.refusal
    assert refusal and refusal.alternative  # noqa: PT018
    state.handle(refusal.alternative.intent, world())
    assert played(state, intents.PlaySequence("sim")).poses[1].speed <= ROBOT.limits.speed_max


FAR = SavedPose("far", -77.7, -24.0, -98.3, 3.0)


@pytest.mark.parametrize(
    ("poses", "word", "sentence"),
    [
        ((NOD, FAR), "too far", "at most 35.0° is allowed. Delete this pose"),
        ((NOD, SavedPose("close", 0.0, 95.0, 0.0, 3.0)), "too close", "at least 30.0° is required. Delete"),
        ((FAR, NOD), "too far", "at most 35.0° is allowed. Delete this pose"),
    ],
)
def test_a_pose_that_the_limits_do_not_allow_is_said_at_the_pose(
    poses: tuple[SavedPose, ...], word: str, sentence: str
) -> None:
    state = editing(*poses)
    wrong = [card for card in state.view(world()).sequence.cards if card.problem]
    assert [card.duration for card in wrong] == [word]
    assert sentence in wrong[0].problem


def test_a_play_with_the_motors_off_offers_the_next_step() -> None:
    state = editing(NOD, LEFT)
    play = played(state, intents.PlaySequence("sim"))
    off = not_enabled()
    state.report(Outcome(play.row, "sim", accepted=True, done=False))
    state.report(Outcome(play.row, "sim", accepted=False, done=True, reason=off.reason, detail=off.detail))
    assert present(present(state.view(world()).commands.refusal).alternative).text == "Make ready"


def test_invalid_requests_are_refused_with_a_reason() -> None:
    unknown = world(robot("sim", arms=None), robot("hw", arms=None))
    cases: list[tuple[State, intents.Intent, World, str]] = [
        (State(), intents.PlaySequence("sim"), world(), "no pose yet"),
        (State(), intents.AddPose(), unknown, "unknown"),
    ]
    for state, intent, now, text in cases:
        assert state.handle(intent, now) == []
        assert text in refusal_of(state, now)
