"""Views of the window's main states, from the real `State` and constructed worlds."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import msgspec
from gui_worlds import absent, account, refused, robot, status, tilt, world

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles, Path
from beatrix_zenoh.client.lesson_reports import STUCK, Row
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.motion.kinematics import Neck
from gui.console.state import intents
from gui.console.state.actions import Govern, Outcome
from gui.console.state.state import State
from gui.console.state.views import View
from gui.console.state.world import LinkPhase, PlanPhase, PlanProgress, World

ROBOTS = ("well", "preview", "refusal", "fault", "no-router", "refused", "driven")
STATES = (*ROBOTS, "simple", "taken", "turn", "frozen", "class", "class-full")
NECK = Neck()
HEADS = {"sim": HeadAngles(12.0, -6.0, 4.0), "hw": HeadAngles(9.0, -4.5, 3.1)}
TARGET = HeadAngles(20.0, 16.0, -4.0)


def arms_of(head: HeadAngles) -> tuple[float, float, float]:
    """Return the arm angles (deg) with which the head has this orientation (deg)."""
    short, middle, long = (math.degrees(arm) for arm in NECK.inverse(*map(math.radians, head)))
    return short, middle, long


ARMS = arms_of(HEADS["hw"])


def between(start: HeadAngles, end: HeadAngles, part: float) -> HeadAngles:
    """Return the orientation at a part of the way, 0 to 1."""
    return HeadAngles(*(a + part * (b - a) for a, b in zip(start, end, strict=True)))


WAY = [between(HEADS["hw"], TARGET, i / 20) for i in range(21)]
PATH = Path([1.2 * i / 20 for i in range(21)], [ArmAngles(*arms_of(head)) for head in WAY], WAY)


def ready() -> World:
    """Return the world in which both robots are ready, at nearly the same position."""
    sim, hw = (posed(side, arms_of(head), head) for side, head in HEADS.items())
    return world(sim, hw, names=("bea1", "bea2"))


def posed(side: str, arms: tuple[float, float, float], head: HeadAngles, **known: bool | str) -> RobotState:
    """Return a robot that this seat drives, with this head orientation."""
    made = robot(side, arms=arms, known=status(side, **({"holder": "ben"} | known)))  # type: ignore[arg-type]
    assert made.positions is not None
    turned = msgspec.structs.replace(made.positions, head=messages.Head(*map(math.radians, head)))
    return replace(made, positions=turned)


def reported(state: State, intent: intents.Intent, now: World) -> None:
    """Let a state handle an intent; report that all robots have carried out its requests."""
    for action in state.handle(intent, now):
        row: int = getattr(action, "row", 0)
        for side in ("",) if isinstance(action, Govern) else ("sim", "hw"):
            state.report(Outcome(row, side, True, True, duration_s=1.21, robots=len(now.robots)))


def driving(theme: intents.Theme, language: str, now: World) -> State:
    """Return a state with some requests in its history."""
    state = State()
    for intent in (
        intents.Choose("theme", theme),
        intents.Choose("language", language),
        intents.Choose("hw", value=True),
        intents.Choose("cameras", value=True),
    ):
        state.handle(intent, now)
    for name in ("nod", "left", "shy"):
        state.handle(intents.AddPose(name), now)
    reported(state, intents.Jog("short", 1), now)
    reported(state, intents.AimHead(20.0, -10.0, 5.0), now)
    reported(state, intents.SendHead(), now)
    return state


SHARED: dict[str, dict[str, Any]] = {
    "taken": {"holder": "anastasia", "lease": 3, "waiting": ("cleo", "ben"), "limit_deg": 20.0},
    "turn": {"holder": "ben", "lease": 4, "waiting": ("cleo", "dora"), "limit_deg": 20.0},
    "frozen": {"frozen": True, "holder": "ben", "limit_deg": 20.0},
}
"""Fields of the status of both robots, by the name of a state of the window."""


def both(before: World, **known: Any) -> World:
    """Return a world in which the status of both robots has these fields."""
    sim, hw = (robot(side, arms=ARMS, known=status(side, **known)) for side in ("sim", "hw"))
    return replace(before, sim=sim, hw=hw)


def shared(deciding: State, before: World, **known: Any) -> World:
    """Let a state follow a world in which its seat waits, then the returned world: both robots have this status."""
    deciding.follow(both(before, holder="ana", waiting=("ben",)))
    now = both(before, **known)
    deciding.follow(now)
    return now


def class_world() -> World:
    """Return the world of the teacher's window: robots in several conditions."""
    known = {
        "bea1": {"moving": True, "holder": "ana", "lease": 3, "waiting": ("ben", "cleo"), "limit_deg": 20.0},
        "bea2": {"frozen": True, "holder": "dora", "limit_deg": 20.0},
        "bea3": {"enabled": False, "calibrated": False, "limit_deg": 20.0},
        "bea4": {"fault": messages.Fault.BOARD_LOST, "connected": False, "limit_deg": 20.0},
    }
    robots = [
        replace(robot(side, known=status(side, **fields)), robot=name)  # type: ignore[arg-type]
        for name, fields in known.items()
        for side in ("sim", "hw")
    ]
    robots[-1] = replace(robots[-1], presence=Presence.LOST, positions_age_s=3.2, hz=0.0)
    return replace(
        ready(),
        seat="teacher",
        sim=robots[0],
        hw=robots[1],
        robots=tuple(robots),
        seats=("ana", "ben", "cleo", "dora", "teacher"),
    )


PUPILS = (
    *("ana", "ben", "cleo", "dora", "emil", "finn", "greta", "hanna", "ida", "jonas"),
    *("karl", "lena", "mia", "noah", "olga", "paul", "quentin", "rosa", "samir", "tim"),
    *("ula", "vera", "wim", "xenia", "yara", "zoe", "seat-27", "seat-28", "seat-29", "seat-30"),
)
LESSONS = ("01-hello", "02-steps", "03-arms", "04-look-there", "05-inverse", "06-edge", "07-smooth")


def lesson(seat: str, name: str, *, passed: bool = False, stuck: int = 0, tries: int | None = None) -> Row:
    """Return the report of one seat about one lesson; `stuck`: checks in a row that have ended at the figure `runs`."""
    figure, tries = "runs" if stuck else "", max(2, stuck) if tries is None else tries
    return Row(
        seat,
        name,
        messages.LessonState(version=1, tries=tries, hints=0, stuck=stuck, passed=passed, figure=figure),
    )


def full_class() -> World:
    """Return the world of a teacher with ten robots and thirty seats, which are at different lessons."""
    robots, reports = [], []
    for number in range(10):
        seat, others = PUPILS[number], tuple(PUPILS[number + 10 : number + 10 + number])
        known = status("hw", holder=seat, lease=number + 1, waiting=others, turn_s=43 if others else 0)
        robots.append(replace(robot("hw", known=known), robot=f"bea{number + 1}"))
    for number, seat in enumerate(PUPILS[:28]):
        at = number % len(LESSONS)
        reports += [lesson(seat, name, passed=True) for name in LESSONS[:at]]
        reports.append(lesson(seat, LESSONS[at], stuck=STUCK if number % 9 == 4 else 0, tries=number + 1))
    names = {seat: f"{seat.capitalize()} Müller" for seat in PUPILS[:26]}
    return replace(
        ready(),
        seat="teacher",
        robots=tuple(robots),
        seats=(*PUPILS, "teacher"),
        account=account("teacher", names=names),
        reports=tuple(sorted(reports)),
    )


def turns(count: int, *, long: bool = False) -> World:
    """Return the world of a teacher with robots of which some are free, frozen or off; with `long` names, too."""
    robots = []
    for number in range(count):
        queue = tuple(PUPILS[(number + 1 + place) % len(PUPILS)] for place in range(number % 6))
        holder = "" if number % 7 == 5 else PUPILS[number]
        side = "sim" if number % 4 == 3 else "hw"
        known = status(
            side,
            holder=holder,
            lease=number + 1,
            waiting=queue,
            turn_s=43 if queue else 0,
            frozen=number % 5 == 3,
            enabled=number % 9 != 6,
        )
        name = f"robot-of-the-third-row-window-{number + 1:02}" if long else f"bea{number + 1}"
        robots.append(replace(robot(side, known=known), robot=name))
    family = "Maximiliane Schulze-Hohenstein" if long else "Müller"
    names = {seat: f"{seat.capitalize()} {family}" for seat in PUPILS}
    own = account("teacher", names=names)
    return replace(ready(), seat="teacher", robots=tuple(robots), seats=PUPILS, account=own)


def example(state: str, theme: intents.Theme, language: str) -> View:
    """Return the view of one of STATES."""
    now = ready()
    deciding = driving(theme, language, now)
    if state == "preview":
        deciding.handle(intents.AimHead(*TARGET), now)
        deciding.handle(intents.SendHead(), now)
        plan = PlanProgress(PlanPhase.LEADING, 1.2, 2.0, 1.1, PATH)
        head = WAY[15]  # 0.9 s of 1.2 s have passed
        now = replace(now, plan=plan, sim=posed("sim", arms_of(head), head, moving=True))
    elif state == "simple":
        for name, value in (("simple", True), ("hw", False)):
            deciding.handle(intents.Choose(name, value), now)
    elif state == "refusal":
        deciding.handle(intents.AimHead(20.0, 40.0, 0.0), now)
        deciding.handle(intents.SendHead(), now)
        detail = tilt(head=messages.Head(math.radians(20), math.radians(35), 0.0))
        message = "bea1 (sim): The head would lean 40.0°; at most 35.0° is allowed."
        refused(deciding, detail, messages.Reason.OUT_OF_REACH, message, side="")
    elif state == "fault":
        known = status("hw", enabled=False, calibrated=False, fault=messages.Fault.EMERGENCY)
        now = replace(now, hw=robot("hw", arms=ARMS, known=known))
    elif state == "no-router":
        now = world(absent("sim"), absent("hw"), phase=LinkPhase.NO_ROUTER, names=())
    elif state == "refused":
        now = world(absent("sim"), absent("hw"), phase=LinkPhase.REFUSED, names=())
    elif state in SHARED:
        now = shared(deciding, now, **SHARED[state])
    elif state in {"class", "class-full"}:
        now = class_world() if state == "class" else full_class()
        deciding.handle(intents.TogglePage(), now)
        reported(deciding, Govern(0, messages.LeaseAction.LIMIT, speed=math.radians(20)), now)
    elif state == "driven":
        now = both(now, holder="ana", moving=True)
    return deciding.view(now)
