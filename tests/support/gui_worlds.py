"""Worlds for tests: robots in any state, without a network; and helpers for `State`."""

from __future__ import annotations

import datetime as dt
import math
from typing import Any

from msgspec.structs import replace
from statuses import AT_HOME, BOARD, READY

from beatrix_zenoh.account import Account
from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import Path as MotionPath
from beatrix_zenoh.contract._generated import messages
from gui.console.state.actions import Action, Outcome, Send
from gui.console.state.intents import Choose, Intent
from gui.console.state.saved import Saved, SavedPose
from gui.console.state.state import State
from gui.console.state.world import LinkPhase, PlanPhase, PlanProgress, World

ENDPOINT = "tcp/127.0.0.1:7447"


def vector(short: float, middle: float, long: float) -> messages.Vector3:
    """Convert degrees to a vector of a message (rad)."""
    return messages.Vector3(*map(math.radians, (short, middle, long)))


def status(side: str, *, connected: bool = True, limit_deg: float = 0.0, **fields: Any) -> messages.Status:
    """Return a status; by default of a ready robot."""
    board = replace(BOARD, connected=connected, port="virtual:", name="bea1", firmware="1.2")
    lists = {name: [*value] for name, value in fields.items() if isinstance(value, tuple)}
    limit = math.radians(limit_deg)
    return replace(READY, robot="bea1", side=side, board=board, speed_limit=limit, **fields | lists)


def positions(arms: tuple[float, float, float] = (0.0, 0.0, 0.0), yaw: float = 0.0) -> messages.Positions:
    """Return the positions of a robot at rest; `arms` and `yaw` in deg."""
    place = vector(*arms)
    return replace(AT_HOME, position=place, commanded=place, head=messages.Head(math.radians(yaw), 0.0, 0.0))


def camera(eye: str = "left", **fields: Any) -> messages.CameraStatus:
    """Return the status of a camera; by default of one that streams."""
    known: dict[str, Any] = {"connected": True, "streaming": True, "source": "rays"} | fields
    return messages.CameraStatus(eye=eye, hz=15.0, width=640, height=480, **known)


def robot(
    side: str,
    *,
    presence: Presence = Presence.ONLINE,
    arms: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
    age_s: float = 0.02,
    known: messages.Status | None = None,
    events: tuple[messages.Event, ...] = (),
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
    sim: RobotState | None = None, hw: RobotState | None = None, *, seat: str = "ben", **fields: Any
) -> World:
    """Return a world; by default both robots are ready, and the seat is `ben`."""
    given: dict[str, Any] = {"phase": LinkPhase.ONLINE, "names": ("bea1",), "wall_s": 1_000_000.0} | fields
    return World(
        now_s=100.0,
        endpoint=ENDPOINT,
        seat=seat,
        robot="bea1",
        sim=sim or robot("sim"),
        hw=hw or robot("hw"),
        latency_s={"sim": 0.002, "hw": None},
        seats=("ana", "ben", "teacher"),
        **given,
    )


BOTH = Choose("hw", value=True)
NOD = SavedPose("nod", 20.0, 0.0, 0.0, 2.0)
LEFT = SavedPose("left", 30.0, 30.0, 30.0, 1.5)
UP = SavedPose("up", 0.0, 0.0, 0.0, 1.0)
NOT_SIM = Choose("sim", value=False)
NOWHERE = world(absent("sim"), absent("hw"))


def account(name: str, **fields: Any) -> Account:
    """Return an account of class 8b; by default its certificate is valid until 2027-07-31."""
    made = Account(
        "8b",
        name,
        "teacher" if name == "teacher" else "student",
        "tls/127.0.0.1:1",
        dt.date(2027, 7, 31),
        "",
        "",
        "",
    )
    return replace(made, **fields)


def state_after(*given: Intent, now: World | None = None) -> State:
    state = State()
    for intent in given:
        state.handle(intent, now or world())
    return state


def editing(*poses: SavedPose) -> State:
    """Return the state of a window with a sequence."""
    return State(Saved(poses=poses))


def refusal_of(state: State, now: World | None = None) -> str:
    """Return the refusal beside commands and sequence; empty if there is none."""
    refusal = state.view(now or world()).commands.refusal
    return "" if refusal is None else refusal.text


def sent(actions: list[Action]) -> Send:
    (action,) = actions
    assert isinstance(action, Send)
    return action


def arms_of(send: Send) -> tuple[float, ...]:
    assert isinstance(send.query, messages.MotionQuery)
    place = send.query.position
    return tuple(round(math.degrees(angle), 6) + 0.0 for angle in (place.x, place.y, place.z))


def plan(phase: PlanPhase, countdown_s: float = 0.0, path: MotionPath | None = None) -> World:
    return world(plan=PlanProgress(phase, 1.2, 2.0, countdown_s, path))


def tilt(**alternative: Any) -> messages.Detail:
    """Return the detail of a refusal because of the lean; the keywords are those of its alternative."""
    return messages.Detail(
        limit=messages.Limit.TILT,
        value=math.radians(40),
        high=math.radians(35),
        unit="rad",
        at_goal=True,
        alternative=messages.Alternative(**alternative) if alternative else None,
    )


def refused(
    state: State,
    detail: messages.Detail | None,
    reason: messages.Reason,
    message: str = "",
    side: str = "sim",
) -> None:
    row = state.view(world()).history[0].row
    outcome = Outcome(row, side, accepted=False, done=True, reason=reason, message=message, detail=detail)
    state.report(outcome)


def accept(state: State, row: int) -> None:
    state.report(Outcome(row, "sim", accepted=True, done=False, duration_s=1.0))
