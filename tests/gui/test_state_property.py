"""In any order of events a view can be made, STOP is sent, and only requested motions are sent."""

from __future__ import annotations

from pathlib import Path

from gui_views import class_world
from gui_worlds import absent, robot, status, vector, world
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Command,
    Detail,
    Event,
    EventKind,
    Fault,
    Head,
    LeaseAction,
    Limit,
    Phase,
    Reason,
)
from beatrix_zenoh.contract.names import ARMS
from gui.console.state import intents
from gui.console.state.actions import (
    NEW,
    Abort,
    Action,
    AskLease,
    BeginRecording,
    ChooseRobot,
    ConnectHardware,
    EndRecording,
    Govern,
    LookForPorts,
    MakeReady,
    Outcome,
    Play,
    Retry,
    Send,
    SendCommand,
    SendNow,
    SendStop,
    StartSimulation,
    WriteFile,
)
from gui.console.state.connecting import CloseConnect
from gui.console.state.intents import (
    ALL_ARMS,
    Intent,
    OpenSequence,
    PlaySequence,
    Tab,
    Theme,
    WindowPage,
)
from gui.console.state.program import SaveProgram
from gui.console.state.state import State
from gui.console.state.world import (
    LinkPhase,
    PlanPhase,
    PlanProgress,
    RecordingProgress,
    Trouble,
    UsbPort,
    World,
)

SIDES = st.sampled_from(["sim", "hw"])
ANGLES = st.floats(-1e6, 1e6)
ANY_NUMBER = st.floats()
NAMES = st.sampled_from(["bow", "up", ""])
COMMANDS = (Command.ENABLE, Command.CALIBRATE, Command.HOME, Command.RESET)
"""Commands that the window sends."""
FILES = st.sampled_from([Path(), Path("a.csv")])
LEASES = (LeaseAction.TAKE, LeaseAction.WAIT, LeaseAction.GIVE_BACK)
SEATS = st.sampled_from(["ana", "ben", ""])
DETAILS = st.sampled_from(
    [
        None,
        Detail(),
        refusals.not_enabled().detail,
        refusals.not_calibrated().detail,
        refusals.emergency_latched().detail,
        refusals.driven_by("ana", 1.0).detail,
        refusals.home_known([1, 0, 0], 0.1).detail,
        Detail(limit=Limit.TILT, alternative=Alternative(head=Head(0.1, 0.2, 0.3), arms=vector(1, 2, 3))),
        Detail(limit=Limit.SPEED, alternative=Alternative(speed=vector(90, 90, 90))),
        Detail(alternative=Alternative()),
        Detail(needs=["FLASH"]),
    ]
)
INTENTS: st.SearchStrategy[Intent] = st.one_of(
    st.builds(intents.Stop),
    st.builds(intents.EmergencyStop),
    st.builds(intents.Jog, st.sampled_from([*ARMS, ALL_ARMS]), st.sampled_from([1, -1])),
    st.builds(intents.AimHead, ANY_NUMBER, ANY_NUMBER, ANY_NUMBER),
    st.builds(intents.SendHead),
    st.builds(intents.Choose, st.just("relative"), st.booleans()),
    st.builds(intents.Choose, st.just("increment"), ANY_NUMBER),
    st.builds(intents.Choose, st.just("speed"), ANY_NUMBER),
    st.builds(intents.Choose, SIDES, st.booleans()),
    st.builds(intents.Choose, st.just("cameras"), st.booleans()),
    st.builds(intents.Choose, st.just("lead_s"), ANY_NUMBER),
    st.builds(
        intents.RunCommand, st.sampled_from(COMMANDS), st.booleans(), st.sampled_from(["", "sim", "hw"])
    ),
    st.builds(MakeReady, SIDES),
    st.sampled_from(
        [
            SendNow(),
            intents.Change(),
            Abort(),
            intents.TakeAlternative(),
            intents.DismissRefusal(),
            intents.Undo(),
            intents.PlayPoses(),
            BeginRecording(),
            EndRecording(),
            StartSimulation(),
            Retry(),
        ]
    ),
    st.builds(AskLease, st.sampled_from(LEASES), SIDES),
    st.builds(Govern, st.just(NEW), st.sampled_from(LeaseAction), st.sampled_from([(), (("bea1", "hw"),)])),
    st.builds(intents.LimitClass, st.sampled_from(["", "20", "-1", "fast"])),
    st.sampled_from([intents.TogglePage(), intents.DismissNotice()]),
    st.builds(intents.Repeat, st.integers(-1, 30)),
    st.builds(intents.SavePose, NAMES),
    st.builds(intents.DeletePose, NAMES),
    st.builds(intents.GoToPose, NAMES),
    st.builds(Play, st.just(NEW), st.just(()), FILES),
    st.sampled_from([intents.AddPose(), intents.UndoSequence(), PlaySequence("sim"), PlaySequence("hw")]),
    st.builds(intents.DuplicatePose, NAMES),
    st.builds(intents.MovePose, NAMES, st.integers(-1, 5)),
    st.builds(intents.RenamePose, NAMES, NAMES),
    st.builds(intents.SetDuration, NAMES, st.floats()),
    st.builds(intents.Choose, st.just("loop"), st.booleans()),
    st.builds(intents.SaveSequence, FILES, st.booleans()),
    st.builds(OpenSequence, FILES, st.text(max_size=20), NAMES),
    st.builds(SaveProgram, FILES),
    st.builds(WriteFile, st.just(NEW), FILES, st.just(b"")),
    st.builds(ChooseRobot, NAMES),
    st.builds(LookForPorts),
    st.builds(ConnectHardware, st.sampled_from(["virtual:", "COM4"])),
    st.builds(CloseConnect),
    st.builds(intents.Choose, st.just("tab"), st.sampled_from(Tab)),
    st.builds(intents.Choose, st.just("theme"), st.sampled_from(Theme)),
    st.builds(intents.Choose, st.just("language"), st.sampled_from(["en", "de", "fr"])),
)
EVENTS = st.builds(
    Event,
    seq=st.integers(0, 9),
    t_mono_ns=st.integers(0, 10**10),
    t_wall_ns=st.integers(0, 10**10),
    kind=st.sampled_from(EventKind),
    action=st.sampled_from(["pose", "motion", "STOP", "HOME", "DISABLE", "new"]),
    seat=SEATS,
    phase=st.none() | st.sampled_from(Phase),
    reason=st.sampled_from(Reason),
    motion=st.integers(0, 3),
    detail=DETAILS,
    count=st.integers(1, 9),
)
PATHS = st.sampled_from(
    [None, MotionPath([], [], []), MotionPath([0.0], [ArmAngles(0, 0, 0)], [HeadAngles(1, 2, 3)])]
)


@st.composite
def robots(draw: st.DrawFn, side: str) -> RobotState:
    presence = draw(st.sampled_from(Presence))
    if presence is Presence.ABSENT:
        return absent(side)
    known = status(
        side,
        enabled=draw(st.booleans()),
        calibrated=draw(st.booleans()),
        moving=draw(st.booleans()),
        fault=draw(st.sampled_from(Fault)),
        holder=draw(SEATS),
        connected=draw(st.booleans()),
        lease=draw(st.integers(0, 2)),
        waiting=draw(st.sampled_from([(), ("ana",), ("cleo", "ben")])),
        frozen=draw(st.booleans()),
        limit_deg=draw(st.sampled_from([0.0, 20.0])),
    )
    arms = draw(st.none() | st.tuples(ANGLES, ANGLES, ANGLES))
    events = tuple(draw(st.lists(EVENTS, max_size=4)))
    return robot(side, presence=presence, arms=arms, age_s=draw(st.floats(0, 9)), known=known, events=events)


WORLDS: st.SearchStrategy[World] = st.builds(
    world,
    sim=robots("sim"),
    hw=robots("hw"),
    phase=st.sampled_from(LinkPhase),
    names=st.sampled_from([(), ("bea1",), ("bea1", "bea2")]),
    plan=st.none()
    | st.builds(
        PlanProgress,
        st.sampled_from(PlanPhase),
        st.floats(0, 10),
        st.floats(0, 5),
        st.floats(-1, 5),
        PATHS,
        st.sampled_from([0.0, 5.7]),
        st.booleans(),
    ),
    recording=st.none()
    | st.builds(
        RecordingProgress,
        FILES,
        st.booleans(),
        st.floats(0, 1e5),
        st.sampled_from([None, Trouble("trouble.start")]),
    ),
    starting=st.booleans(),
    connecting=st.booleans(),
    own_hardware=st.booleans(),
    ports=st.none() | st.just(()) | st.just((UsbPort("COM4", "Arduino", board=True),)),
    wall_s=st.floats(0, 2e9),
    playing=st.sampled_from(["", "hello"]),
    seat=st.sampled_from(["ben", "teacher"]),
    robots=st.sampled_from([(), class_world().robots]),
)
MOVES = (Send, Play)


class AnyOrder(RuleBasedStateMachine):
    """Intents, outcomes and worlds in any order."""

    def __init__(self) -> None:
        super().__init__()
        self.state, self.world, self.rows = State(), world(), 0

    @rule(now=WORLDS)
    def change_world(self, now: World) -> None:
        self.world = now
        self.state.follow(now)

    @rule(intent=INTENTS)
    def handle_intent(self, intent: Intent) -> None:
        asked = self.state.choices.sides
        actions = self.state.handle(intent, self.world)
        for action in actions:
            self.check(action, asked)
        if isinstance(intent, intents.Stop | intents.EmergencyStop):
            everywhere = self.state.view(self.world).choices.page is WindowPage.CLASS
            (action,) = actions
            assert isinstance(action, SendStop)
            emergency = isinstance(intent, intents.EmergencyStop)
            assert (action.everywhere, action.emergency) == (everywhere, emergency)

    def check(self, action: Action, asked: tuple[str, ...]) -> None:
        if isinstance(action, Send | Play | SendCommand | AskLease | MakeReady | SendStop | Govern):
            self.rows += 1
            assert action.row > 0
        if isinstance(action, Govern) and action.action is not LeaseAction.GIVE_BACK:
            assert self.world.is_teacher
        if isinstance(action, MOVES):
            assert action.sides == asked
            assert asked, "nothing may move while no box is checked"
            assert self.world.phase is LinkPhase.ONLINE
            assert all(self.world.side(side).presence is not Presence.ABSENT for side in action.sides)
            assert action.lead_s >= 0

    @rule(
        row=st.integers(0, 20),
        side=st.sampled_from(["", "sim", "hw"]),
        accepted=st.booleans(),
        done=st.booleans(),
        reason=st.sampled_from(Reason),
        message=st.sampled_from(["", "Why.", "bea1 (hw): Why."]),
        detail=DETAILS,
        duration_s=st.floats(0, 9),
    )
    def report_outcome(
        self,
        row: int,
        side: str,
        accepted: bool,
        done: bool,
        reason: Reason,
        message: str,
        detail: Detail | None,
        duration_s: float,
    ) -> None:
        outcome = Outcome(row, side, accepted, done, reason, message, detail, duration_s=duration_s)
        self.state.report(outcome)

    @invariant()
    def a_view_can_be_made(self) -> None:
        view = self.state.view(self.world)
        assert view == self.state.view(self.world), "making a view changes nothing"
        assert view.stop.enabled
        assert view.stop.intent == intents.Stop()
        assert view.emergency.enabled
        assert view.emergency.question
        assert all(pill.text and pill.symbol for pill in view.pills)
        places = [
            found.control for found in (view.head.refusal, view.arms.refusal, view.commands.refusal) if found
        ]
        assert len(places) <= 1, "one refusal at a time, where the request was made"
        if not (view.choices.sides):
            buttons = [button for row in view.arms.rows for button in (row.minus, row.plus)]
            assert not any(button.enabled for button in [*buttons, view.head.send, view.commands.home])
        assert self.state.saved == self.state.saved


AnyOrder.TestCase.settings = settings(max_examples=20, stateful_step_count=20, deadline=None)
TestAnyOrder = AnyOrder.TestCase
