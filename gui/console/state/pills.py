"""State of each robot: its condition, the reason, and the button for the next step; and the banner with the first one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.contract._generated.messages import (
    Command,
    Fault,
    FollowState,
    LeaseAction,
    Reason,
    Status,
)
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.contract.values import lines
from gui.console.state import actions, connecting, leases
from gui.console.state.actions import ChooseRobot, LookForPorts, Retry, StartSimulation
from gui.console.state.intents import Intent, RunCommand
from gui.console.state.memory import Memory
from gui.console.state.views import BannerView, ButtonView, Condition, PillView, button
from gui.console.state.world import LinkPhase, World, fault_of, online, silent
from gui.console.texts import DEFAULT_LANGUAGE, Texts

SYMBOLS: Final = {
    Condition.ABSENT: "✕",
    Condition.SILENT: "◌",
    Condition.DISABLED: "○",
    Condition.NOT_CALIBRATED: "◐",
    Condition.READY: "●",
    Condition.MOVING: "►",
    Condition.DRIVEN: "◆",
    Condition.FROZEN: "■",
    Condition.FAULT: "▲",
}
MAKE_READY: Final = "MAKE_READY"
"""a next step: ENABLE and CALIBRATE, each unless it is done already"""
CONNECT: Final = "CONNECT"
"""a next step: choose the port of the hardware"""
WAIT: Final = "WAIT"
"""a next step: wait for a robot that another seat holds"""
COMMANDS: Final = (Command.ENABLE, Command.CALIBRATE, Command.RESET)
NEXT_STEPS: Final[Mapping[str, tuple[str, Callable[[str], Intent]]]] = {
    "START": ("start", lambda _side: StartSimulation()),
    CONNECT: ("connect", lambda _side: LookForPorts()),
    WAIT: ("wait", partial(actions.AskLease, LeaseAction.WAIT)),
    MAKE_READY: ("ready", actions.MakeReady),
    **{step.name: (step.name.lower(), partial(RunCommand, step, True)) for step in COMMANDS},  # noqa: FBT003
}
"""Word of the text, and intent for a side, of each next step."""
FAULT_CONDITIONS: Final = {
    Fault(word.upper()): word for word in ("emergency", "board_lost", "contract_mismatch", "assembly_left")
}

TREATED: Final = ("clocks", "robot", "state", "stops")
"""Groups of values that the pill shows in its own words, and those that people do not read."""
CHOICES = 3
"""Largest number of robots that the banner offers; the list of robots contains all."""


@dataclass(frozen=True)
class RobotCondition:
    """The condition of a robot, the reason for it, and the next step."""

    condition: Condition
    text: str
    reason: str = ""
    next_step: str = ""
    """one of NEXT_STEPS; empty: none"""


def pill(memory: Memory, world: World, side: str) -> PillView:
    """Return the state of one robot."""
    texts, kept = memory.choices.texts, memory.details[side]
    found, latency_s, status = finding(world, side, texts), world.latency_s.get(side), world.side(side).status
    if found.condition is Condition.ABSENT:
        latency_s, status = None, None
    step, english = found.next_step, texts.code == DEFAULT_LANGUAGE
    off = "off.starting" if step == "START" and world.starting else ""
    return PillView(
        side=side,
        title=texts(f"side.{side}"),
        condition=found.condition,
        symbol=SYMBOLS[found.condition],
        text=found.text,
        reason=found.reason,
        next_step=next_step_button(step, side, texts, off) if step else None,
        latency="" if latency_s is None else texts("latency", ms=1e3 * latency_s),
        notes=() if status is None else notes(found, status, world, texts),
        lease=None if step else leases.button(world, side, texts),
        menu=menu(world, side, texts),
        warnings=() if status is None or not english else tuple(status.warnings),
        details="" if status is None else kept.get((status, texts.code), lambda: details(status, texts)),
    )


def menu(world: World, side: str, texts: Texts) -> tuple[ButtonView, ...]:
    """Return the buttons of the commands that are rarely needed; ENABLE is a next step whenever it is possible."""
    off, name = "" if online(world, side) else "off.absent", texts(f"side.{side}")
    question = texts("command.disable_question") if side == "hw" else ""
    disable = RunCommand(Command.ENABLE, value=False, side=side)
    return (
        button(texts, "command.calibrate", RunCommand(Command.CALIBRATE, side=side), off, side=name),
        button(texts, "command.disable", disable, off, question=question, side=name),
        button(texts, "command.reset", RunCommand(Command.RESET, side=side), off, side=name),
    )


def notes(found: RobotCondition, status: Status, world: World, texts: Texts) -> tuple[str, ...]:
    """Return the notes beside the condition of a robot: that its microphones are on, and those about its lease."""
    driven = found.condition is Condition.DRIVEN
    listens = status.microphones is not None and status.microphones.streaming
    heard = (texts("note.microphones"),) if listens else ()  # first, because people near the robot must know
    return *heard, *leases.notes(status, world, texts, holder_shown=driven)


def finding(world: World, side: str, texts: Texts) -> RobotCondition:
    """Return the first problem of a robot, in the order in which problems must be solved, or else MOVING or READY."""
    robot = world.side(side)
    if not online(world, side):
        return _absent(world, side, texts)
    found = problem(robot, texts) or _shared(robot, world, texts) or working(robot, texts)
    lost = robot.status is not None and fault_of(robot.status) is Fault.BOARD_LOST
    return replace(found, next_step=CONNECT) if lost and side == "hw" and world.own_hardware else found


def problem(robot: RobotState, texts: Texts) -> RobotCondition | None:
    """Return the first problem of a robot that is online, regardless of its holder; None if the robot can move."""
    if robot.status is None or silent(robot):
        age_s = robot.positions_age_s
        reason = texts("reason.silent") if age_s is None else texts("reason.stale", seconds=float(age_s))
        return RobotCondition(Condition.SILENT, texts("condition.silent"), reason)
    if (fault := fault_of(robot.status)) is not Fault.NONE:
        return _faulty(fault, robot.status, texts)
    return _unready(robot.status, robot.side, texts)


def _unready(status: Status, side: str, texts: Texts) -> RobotCondition | None:
    if not status.enabled:
        # Between enabling and calibrating the hardware, the user sets its head upright, so these are two steps.
        step = MAKE_READY if side == "sim" else Command.ENABLE.name
        reason = texts(f"reason.disabled_{side}")
        return RobotCondition(Condition.DISABLED, texts("condition.disabled"), reason, step)
    if not status.calibrated:
        text, reason = texts("condition.not_calibrated"), texts("reason.not_calibrated")
        return RobotCondition(Condition.NOT_CALIBRATED, text, reason, Command.CALIBRATE.name)
    return None


def _shared(robot: RobotState, world: World, texts: Texts) -> RobotCondition | None:
    """Return why this seat cannot move a robot that is ready; None if it can."""
    if (status := robot.status) is None:
        return None
    if status.frozen and not world.is_teacher:
        return RobotCondition(Condition.FROZEN, texts("condition.frozen"), texts("reason.frozen"))
    if status.following is not FollowState.OFF:
        text = texts(f"condition.follow_{status.following}")
        return RobotCondition(Condition.DRIVEN, text, texts("reason.follow"))
    if status.holder in ("", world.seat):
        return None
    key = "taken" if status.lease else "driven"
    reason = "driven_moving" if status.moving and not status.lease else key
    slots = {"holder": status.holder}
    return RobotCondition(
        Condition.DRIVEN, texts(f"condition.{key}", **slots), texts(f"reason.{reason}", **slots)
    )


def working(robot: RobotState, texts: Texts) -> RobotCondition:
    """Return FROZEN, MOVING or READY for a robot without a problem, as the teacher sees it."""
    if robot.status is not None and robot.status.frozen:
        return RobotCondition(Condition.FROZEN, texts("condition.frozen_short"))
    if robot.status is not None and robot.status.moving:
        return RobotCondition(Condition.MOVING, texts("condition.moving"))
    return RobotCondition(Condition.READY, texts("condition.ready"))


def _absent(world: World, side: str, texts: Texts) -> RobotCondition:
    if world.phase in (LinkPhase.NO_ROUTER, LinkPhase.REFUSED):
        key, reason = "absent", ""  # the banner has the reason and the buttons for both robots
    elif world.starting if side == "sim" else world.connecting:
        key, reason = "starting", texts("reason.starting" if side == "sim" else "connect.starting")
    elif world.phase is LinkPhase.CONNECTING:
        key, reason = "connecting", texts("reason.connecting", endpoint=world.endpoint)
    elif world.side(side).status is not None:
        key, reason = "lost", texts("reason.lost", robot=world.robot)
    else:
        key, reason = "absent", texts(f"reason.absent_{side}", robot=world.robot)
    step = ("START" if side == "sim" else CONNECT) if reason else ""
    return RobotCondition(Condition.ABSENT, texts(f"condition.{key}"), reason, step)


def _faulty(fault: Fault, status: Status, texts: Texts) -> RobotCondition:
    if fault not in FAULT_CONDITIONS:  # unknown here, because the robot runs another version
        text = texts("condition.fault", name=str(fault))
        return RobotCondition(Condition.FAULT, text, texts("reason.fault"))
    text, step = texts(f"condition.{FAULT_CONDITIONS[fault]}"), ""
    if fault is Fault.ASSEMBLY_LEFT:
        step = Command.CALIBRATE.name if status.enabled and not status.calibrated else ""
        return RobotCondition(Condition.FAULT, text, texts("reason.assembly_left"), step)
    step = Command.RESET.name if fault is Fault.EMERGENCY else ""
    return RobotCondition(Condition.FAULT, text, texts.refusal(Reason(fault.value), None), step)


def next_step_button(next_step: str, side: str, texts: Texts, off: str = "") -> ButtonView:
    """Return the button of a next step."""
    word, intent = NEXT_STEPS[next_step]
    return button(texts, f"next.{word}", intent(side), off)


def details(status: Status, texts: Texts) -> str:
    """Return a line for each group of values that the rest of the pill does not show: lease, board, sensors."""
    shown = lines(status, TREATED, texts.word, texts.decimal)
    found = [f"{texts.word(group)}: {line}" for group, line in shown.items()]
    return "\n".join(found if texts.code == DEFAULT_LANGUAGE else [*found, *status.warnings])


def banner(memory: Memory, world: World) -> BannerView | None:
    """Return the banner; None if a robot is online, no latch is set, and `leases.banner` has nothing to show."""
    texts = memory.choices.texts
    latched = tuple(side for side in SIDES if _is_latched(world, side))
    if latched:
        robots = texts("sides.both" if len(latched) > 1 else f"sides.{latched[0]}")
        return BannerView(
            texts("banner.emergency", robots=robots), tuple(_reset_button(side, texts) for side in latched)
        )
    if online(world, "sim") or online(world, "hw"):
        return leases.banner(memory, world)
    if world.starting or world.connecting:
        return BannerView(texts("banner.starting" if world.starting else "connect.starting"))
    if world.phase is LinkPhase.CONNECTING:
        return BannerView(texts("banner.connecting", endpoint=world.endpoint))
    start, connect = (
        next_step_button(step, side, texts) for step, side in (("START", "sim"), (CONNECT, "hw"))
    )
    tooltip = f"{texts('next.retry_tip')} {world.trouble}".strip()
    retry = ButtonView(texts("next.retry"), tooltip, Retry())
    others = [name for name in world.names if name != world.robot][:CHOICES]
    choose = [button(texts, "banner.choose", ChooseRobot(name), robot=name) for name in others]
    if world.phase is LinkPhase.REFUSED:
        found = BannerView(connecting.refused(world, texts), (connect, retry))
    elif world.phase is LinkPhase.NO_ROUTER:
        found = BannerView(texts("banner.no_router", endpoint=world.endpoint), (start, connect, retry))
    elif others:
        found = BannerView(texts("banner.other_robots", robot=world.robot), (*choose, start))
    else:
        found = BannerView(texts("banner.no_robot"), (start,))
    failed = world.child_trouble
    if failed is None:
        return found
    return replace(found, text=f"{texts(failed.key, code=failed.code)} {found.text}")


def _is_latched(world: World, side: str) -> bool:
    status = world.side(side).status
    return online(world, side) and status is not None and fault_of(status) is Fault.EMERGENCY


def _reset_button(side: str, texts: Texts) -> ButtonView:
    text = texts("banner.reset", side=texts(f"sides.{side}"))
    return ButtonView(text, texts("next.reset_tip"), RunCommand(Command.RESET, side=side))
