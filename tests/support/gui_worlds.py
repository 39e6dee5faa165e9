"""Worlds for tests: robots in any state, without a network; and helpers for `State`."""

from __future__ import annotations

import math

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.contract._generated.messages import (
    BoardStatus,
    CameraStatus,
    Detail,
    Event,
    Fault,
    FollowState,
    Head,
    MotionQuery,
    Positions,
    Reason,
    Status,
    Steps,
    Vector3,
)
from gui.console.state.actions import Action, Outcome, Send
from gui.console.state.intents import Intent, SetDestination
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, PlanPhase, PlanProgress, RecordingProgress, World

ENDPOINT = "tcp/127.0.0.1:7447"


def vector(short: float, middle: float, long: float) -> Vector3:
    """Convert degrees to a vector of a message (rad)."""
    return Vector3(*map(math.radians, (short, middle, long)))


def status(
    side: str,
    *,
    enabled: bool = True,
    calibrated: bool = True,
    moving: bool = False,
    fault: Fault = Fault.NONE,
    holder: str = "",
    connected: bool = True,
    cameras: tuple[CameraStatus, ...] = (),
    lease: int = 0,
    waiting: tuple[str, ...] = (),
    frozen: bool = False,
    following: FollowState = FollowState.OFF,
    limit_deg: float = 0.0,
    muted: tuple[str, ...] = (),
) -> Status:
    """Return a status; by default of a ready robot."""
    return Status(
        t_mono_ns=0,
        t_wall_ns=0,
        robot="bea1",
        side=side,
        enabled=enabled,
        calibrated=calibrated,
        moving=moving,
        motion=0,
        fault=fault,
        warnings=[],
        calibrations=1,
        holder=holder,
        board=BoardStatus(
            connected=connected,
            port="virtual:",
            name="bea1",
            firmware="1.2",
            contract="",
            boot=1,
            rejected_frames=0,
            retries=0,
        ),
        cameras=list(cameras),
        lease=lease,
        waiting=list(waiting),
        muted=list(muted),
        frozen=frozen,
        following=following,
        speed_limit=math.radians(limit_deg),
    )


def positions(arms: tuple[float, float, float] = (0.0, 0.0, 0.0), yaw: float = 0.0) -> Positions:
    """Return the positions of a robot at rest; `arms` and `yaw` in deg."""
    return Positions(
        seq=1,
        t_mono_ns=0,
        t_wall_ns=0,
        position=vector(*arms),
        velocity=vector(0, 0, 0),
        commanded=vector(*arms),
        steps=Steps(0, 0, 0),
        head=Head(math.radians(yaw), 0.0, 0.0),
    )


def robot(
    side: str,
    *,
    presence: Presence = Presence.ON_LINE,
    arms: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
    age_s: float = 0.02,
    known: Status | None = None,
    events: tuple[Event, ...] = (),
) -> RobotState:
    """Return a robot; by default ready with its arms at home."""
    here = presence is not Presence.ABSENT
    return RobotState(
        robot="bea1",
        side=side,
        presence=presence,
        status=(known or status(side)) if here else None,
        status_age_s=0.5 if here else None,
        positions=positions(arms) if here and arms is not None else None,
        positions_age_s=age_s if here and arms is not None else None,
        hz=50.0,
        events=events,
    )


def absent(side: str) -> RobotState:
    """Return a robot that is not online."""
    return robot(side, presence=Presence.ABSENT)


def world(
    sim: RobotState | None = None,
    hw: RobotState | None = None,
    *,
    phase: LinkPhase = LinkPhase.ON_LINE,
    names: tuple[str, ...] = ("bea1",),
    plan: PlanProgress | None = None,
    recording: RecordingProgress | None = None,
    starting: bool = False,
    wall_s: float = 1_000_000.0,
    playing: str = "",
    seat: str = "ben",
    robots: tuple[RobotState, ...] = (),
) -> World:
    """Return a world; by default both robots are ready, and the seat is `ben`."""
    return World(
        now_s=100.0,
        phase=phase,
        endpoint=ENDPOINT,
        seat=seat,
        robot="bea1",
        sim=sim or robot("sim"),
        hw=hw or robot("hw"),
        names=names,
        latency_s={"sim": 0.002, "hw": None},
        plan=plan,
        recording=recording,
        starting=starting,
        playing=playing,
        wall_s=wall_s,
        seats=("ana", "ben", "teacher"),
        robots=robots,
    )


BOTH = SetDestination("hw", checked=True)
NOT_SIM = SetDestination("sim", checked=False)
NOWHERE = world(absent("sim"), absent("hw"))


def state_after(*given: Intent, now: World | None = None) -> State:
    state = State()
    for intent in given:
        state.handle(intent, now or world())
    return state


def sent(actions: list[Action]) -> Send:
    (action,) = actions
    assert isinstance(action, Send)
    return action


def arms_of(send: Send) -> tuple[float, ...]:
    assert isinstance(send.query, MotionQuery)
    place = send.query.position
    return tuple(round(math.degrees(angle), 6) + 0.0 for angle in (place.x, place.y, place.z))


def plan(phase: PlanPhase, countdown_s: float = 0.0, path: MotionPath | None = None) -> World:
    return world(plan=PlanProgress(phase, "Possible: 1.2 s.", 1.2, 2.0, countdown_s, path))


def refused(
    state: State, detail: Detail | None, reason: Reason, message: str = "", side: str = "sim"
) -> None:
    row = state.view(world()).history[0].row
    outcome = Outcome(row, side, accepted=False, done=True, reason=reason, message=message, detail=detail)
    state.report(outcome)


def accept(state: State, row: int) -> None:
    state.report(Outcome(row, "sim", accepted=True, done=False, duration_s=1.0))
