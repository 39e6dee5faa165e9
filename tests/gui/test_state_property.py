"""In any order of events a view can be made, STOP is sent, and only requested motions are sent."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gui_views import class_world
from gui_worlds import absent, robot, status, vector, world
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from msgspec.structs import fields

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract._generated.messages import Alternative, Command, Detail, LeaseAction, Limit
from beatrix_zenoh.contract.names import ARMS
from gui.console.state import actions, intents
from gui.console.state import world as worlds
from gui.console.state.actions import NEW, Action, Outcome, SendStop
from gui.console.state.arms import HoldArm, Steer
from gui.console.state.intents import ALL_ARMS, Choose, Intent, Repeat, WindowPage
from gui.console.state.state import HANDLES, State
from gui.console.state.world import World

BOOL, NUMBER, ANGLES = st.booleans(), st.floats(), st.floats(-1e6, 1e6)
SIDES = st.sampled_from(["sim", "hw"])
SEATS = st.sampled_from(["ana", "ben", ""])
POSE = Alternative(head=messages.Head(0.1, 0.2, 0.3), arms=vector(1, 2, 3))
DETAILS = st.none() | st.builds(
    Detail,
    limit=st.none() | st.sampled_from(Limit),
    alternative=st.sampled_from([None, Alternative(), POSE, Alternative(speed=vector(90, 90, 90))]),
    needs=st.sampled_from([[], ["FLASH"], ["RESET"], ["ENABLE", "CALIBRATE"]]),
)
FIELDS: dict[str, st.SearchStrategy[Any]] = {
    "row": st.just(NEW),
    "sides": st.just(()),
    "side": SIDES,
    "arm": st.sampled_from([*ARMS, ALL_ARMS]),
    "sign": st.sampled_from([1, -1]),
    "command": st.sampled_from([Command.ENABLE, Command.CALIBRATE, Command.HOME, Command.RESET]),
    "value": BOOL,
    "action": st.sampled_from([LeaseAction.TAKE, LeaseAction.WAIT, LeaseAction.GIVE_BACK]),
    "places": st.sampled_from([(), (("bea1", "hw"),)]),
    "text": st.sampled_from(["", "20", "-1", "fast"]),
    "to": st.integers(-1, 5),
    "file": st.sampled_from([Path(), Path("a.csv")]),
    "content": st.just(b""),
    "program": BOOL,
    "port": st.sampled_from(["virtual:", "COM4"]),
    "address": st.sampled_from(["", "lab"]),
    **dict.fromkeys(("yaw", "pitch", "roll", "seconds"), NUMBER),
    **dict.fromkeys(("name", "new"), st.sampled_from(["bow", "up", ""])),
}
"""Values for the fields of intents, by their names; other fields have their defaults."""
CHOICES: dict[str, st.SearchStrategy[Any]] = {
    **dict.fromkeys(("relative", "sim", "hw", "cameras", "loop"), BOOL),
    **dict.fromkeys(("increment", "speed", "lead_s"), NUMBER),
    "tab": st.sampled_from(intents.Tab),
    "theme": st.sampled_from(intents.Theme),
    "language": st.sampled_from(["en", "de", "fr"]),
}
MOVE_BY_THEMSELVES = (HoldArm, Steer, intents.LiveHead)


def any_of(kind: type[Intent]) -> st.SearchStrategy[Intent]:
    known = {field.name: FIELDS[field.name] for field in fields(kind) if field.name in FIELDS}
    return st.builds(kind, **known)


INTENTS: st.SearchStrategy[Intent] = st.one_of(
    *(any_of(kind) for kind in HANDLES if kind not in (Choose, Repeat, *MOVE_BY_THEMSELVES)),
    *(st.builds(Choose, st.just(name), values) for name, values in CHOICES.items()),
    st.builds(Repeat, st.integers(-1, 30)),
)
EVENTS = st.builds(
    messages.Event,
    seq=st.integers(0, 9),
    t_mono_ns=st.integers(0, 10**10),
    t_wall_ns=st.integers(0, 10**10),
    kind=st.sampled_from(messages.EventKind),
    action=st.sampled_from(["pose", "motion", "STOP", "HOME", "DISABLE", "new"]),
    seat=SEATS,
    phase=st.none() | st.sampled_from(messages.Phase),
    reason=st.sampled_from(messages.Reason),
    motion=st.integers(0, 3),
    detail=DETAILS,
    count=st.integers(1, 9),
)
PATHS = st.sampled_from(
    [None, MotionPath([], [], []), MotionPath([0.0], [ArmAngles(0, 0, 0)], [HeadAngles(1, 2, 3)])]
)


def robots(side: str) -> st.SearchStrategy[RobotState]:
    known = st.builds(
        status,
        st.just(side),
        **dict.fromkeys(("enabled", "calibrated", "moving", "connected", "frozen"), BOOL),
        fault=st.sampled_from(messages.Fault),
        holder=SEATS,
        lease=st.integers(0, 2),
        waiting=st.sampled_from([(), ("ana",), ("cleo", "ben")]),
        limit_deg=st.sampled_from([0.0, 20.0]),
    )
    return st.just(absent(side)) | st.builds(
        robot,
        st.just(side),
        presence=st.sampled_from(Presence),
        arms=st.none() | st.tuples(ANGLES, ANGLES, ANGLES),
        age_s=st.floats(0, 9),
        known=known,
        events=st.lists(EVENTS, max_size=4).map(tuple),
    )


WORLDS: st.SearchStrategy[World] = st.builds(
    world,
    sim=robots("sim"),
    hw=robots("hw"),
    phase=st.sampled_from(worlds.LinkPhase),
    names=st.sampled_from([(), ("bea1",), ("bea1", "bea2")]),
    plan=st.none()
    | st.builds(worlds.PlanProgress, st.sampled_from(worlds.PlanPhase), *[st.floats(0, 5)] * 3, PATHS),
    recording=st.none() | st.builds(worlds.RecordingProgress, FIELDS["file"], BOOL, st.floats(0, 1e5)),
    **dict.fromkeys(("starting", "connecting", "own_hardware"), BOOL),
    ports=st.sampled_from([None, (), (worlds.UsbPort("COM4", "Arduino", board=True),)]),
    wall_s=st.floats(0, 2e9),
    playing=st.sampled_from(["", "hello"]),
    seat=st.sampled_from(["ben", "teacher"]),
    robots=st.sampled_from([(), class_world().robots]),
)
OUTCOMES = st.builds(
    Outcome,
    st.integers(0, 20),
    st.sampled_from(["", "sim", "hw"]),
    accepted=BOOL,
    done=BOOL,
    reason=st.sampled_from(messages.Reason),
    message=st.sampled_from(["", "Why.", "bea1 (hw): Why."]),
    detail=DETAILS,
    duration_s=st.floats(0, 9),
)


class AnyOrder(RuleBasedStateMachine):
    """Intents, outcomes and worlds in any order."""

    def __init__(self) -> None:
        super().__init__()
        self.state, self.world = State(), world()

    @rule(now=WORLDS)
    def change_world(self, now: World) -> None:
        self.world = now
        self.state.follow(now)

    @rule(intent=INTENTS)
    def handle_intent(self, intent: Intent) -> None:
        asked = self.state.choices.sides
        found = self.state.handle(intent, self.world)
        for action in found:
            self.check(action, asked)
        if isinstance(intent, intents.Stop | intents.EmergencyStop):
            everywhere = self.state.view(self.world).choices.page is WindowPage.CLASS
            (stop,) = found
            assert isinstance(stop, SendStop)
            emergency = isinstance(intent, intents.EmergencyStop)
            assert (stop.everywhere, stop.emergency) == (everywhere, emergency)

    def check(self, action: Action, asked: tuple[str, ...]) -> None:
        assert getattr(action, "row", 1) > 0
        if isinstance(action, actions.Govern) and action.action is not LeaseAction.GIVE_BACK:
            assert self.world.is_teacher
        if isinstance(action, actions.Send | actions.Play):
            assert action.sides == asked
            assert asked, "nothing may move while no box is checked"
            assert self.world.phase is worlds.LinkPhase.ONLINE
            assert all(self.world.side(side).presence is not Presence.ABSENT for side in action.sides)
            assert action.lead_s >= 0

    @rule(outcome=OUTCOMES)
    def report_outcome(self, outcome: Outcome) -> None:
        self.state.report(outcome)

    @invariant()
    def a_view_can_be_made(self) -> None:
        view = self.state.view(self.world)
        assert view == self.state.view(self.world), "making a view changes nothing"
        assert (view.stop.enabled, view.stop.intent) == (True, intents.Stop())
        assert view.emergency.enabled
        assert view.emergency.question
        assert all(pill.text and pill.symbol for pill in view.pills)
        places = [found for found in (view.head.refusal, view.arms.refusal, view.commands.refusal) if found]
        assert len(places) <= 1, "one refusal at a time, where the request was made"
        if not view.choices.sides:
            buttons = [button for row in view.arms.rows for button in (row.minus, row.plus)]
            assert not any(
                button.enabled for button in [*buttons, view.head.send, view.commands.buttons["home"]]
            )


AnyOrder.TestCase.settings = settings(max_examples=15, stateful_step_count=20, deadline=None)
TestAnyOrder = AnyOrder.TestCase
