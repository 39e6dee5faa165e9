"""The page of the class: all robots and seats, and the requests of the teacher to several robots."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

from msgspec import structs

from beatrix_zenoh.account import days_left
from beatrix_zenoh.client import RobotState
from beatrix_zenoh.client.lease import limit_of
from beatrix_zenoh.client.monitor import SeatStops, stops_by_seat
from beatrix_zenoh.contract._generated.messages import LeaseAction, Status
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.contract.names import TEACHER
from gui.console.state import connecting, history, leases, lessons, pills, refusals
from gui.console.state.actions import NEW, Action, ChooseRobot, Govern, SendStop, UseAccount, UseRouter
from gui.console.state.intents import LimitClass, TogglePage, WindowPage
from gui.console.state.leases import limit_text
from gui.console.state.memory import Handles, Memory, begin, offline
from gui.console.state.views import (
    ClassRowView,
    ClassView,
    Condition,
    SeatView,
    button,
)
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts

CONTROL: Final = "class"
STOPS_SHOWN: Final = 8
"""Largest number of seats whose STOPs are shown."""


def view(memory: Memory, world: World) -> ClassView | None:
    """Return the page; None if this window is not the teacher's. The page has rows only while it is shown."""
    if not world.is_teacher:
        return None
    texts = memory.choices.texts
    limits, rows = _limits(world), table(world, texts)
    shown = memory.choices.page is WindowPage.CLASS
    toggle = "class.hide" if shown else "class.show"
    result, good = _result(memory, texts)

    return ClassView(
        summary=_summary(world, texts),
        rows=rows,
        empty="" if rows else empty(world, texts),
        freeze_all=button(texts, "class.freeze_all", Govern(NEW, LeaseAction.FREEZE)),
        unfreeze_all=button(texts, "class.unfreeze_all", Govern(NEW, LeaseAction.UNFREEZE)),
        limit=button(texts, "class.limit", LimitClass("")),
        limit_now=_limit_now(limits, texts),
        seats=_seats(world, texts),
        result=result,
        good=good,
        toggle=button(texts, toggle, TogglePage()),
        lessons=lessons.view(world, texts),
    )


def _summary(world: World, texts: Texts) -> str:
    robots = float(len({robot.robot for robot in world.robots}))
    text = texts("class.summary", robots=robots, count=float(len(world.seats)))
    frozen = {robot.robot for robot in world.robots if robot.status is not None and robot.status.frozen}
    if frozen:
        text += " " + texts("class.frozen", frozen=float(len(frozen)), robots=robots)
    if muted := sorted(_muted(world)):
        text += " " + texts("class.muted", seats=_shown(world, muted))
    stops = stops_by_seat(world.robots)
    if stops:
        text += " " + texts(
            "class.stops", stops=", ".join(_stops(one, world, texts) for one in stops[:STOPS_SHOWN])
        )
    account = world.account
    days = None if account is None else days_left(account.expires, world.today)
    if account is not None and days is not None:
        text += " " + texts(f"class.{'expired' if days < 0 else 'expires'}", expires=str(account.expires))
    return text


def _shown(world: World, seats: Iterable[str]) -> str:
    return ", ".join(map(world.shown, seats))


def _stops(stops: SeatStops, world: World, texts: Texts) -> str:
    """Return the STOPs of one seat as words: `ben 3 (bea1 hw 2, bea2 hw 1)`."""
    robots = ", ".join(f"{robot} {side} {count}" for (robot, side), count in stops.robots.items())
    seat = world.shown(stops.seat) or texts("who.unknown")
    return f"{seat} {stops.total} ({robots})"


def _muted(world: World) -> set[str]:
    """Return the seats that are muted at least by one robot."""
    return {seat for robot in world.robots if robot.status is not None for seat in robot.status.muted}


def _seats(world: World, texts: Texts) -> tuple[SeatView, ...]:
    muted = _muted(world)
    views = []
    for seat in sorted({*world.seats, *muted} - {TEACHER}):
        key, shown = "unmute" if seat in muted else "mute", world.shown(seat)
        intent = Govern(NEW, LeaseAction.UNMUTE if seat in muted else LeaseAction.MUTE, seat=seat)
        text = texts("class.muted_seat", seat=shown) if seat in muted else shown
        views.append(SeatView(text, button(texts, f"class.{key}", intent, seat=shown)))
    return tuple(views)


def empty(world: World, texts: Texts) -> str:
    """Return why the page has no rows."""
    if world.phase is not LinkPhase.ONLINE:
        return texts("reason.no_router", endpoint=world.endpoint)
    return texts("banner.no_robot")


def _limits(world: World) -> set[int]:
    """Return the different speed limits of all robots (deg/s); 0 stands for no limit."""
    known = [robot.status for robot in world.robots if robot.status is not None]
    return {round(math.degrees(status.speed_limit)) for status in known}


def _limit_now(limits: set[int], texts: Texts) -> str:
    """Return a sentence about the speed limit of all robots."""
    if len(limits) > 1:
        return texts("class.limit_differs")
    limit = max(limits, default=0)
    return texts("class.limit_now", speed=float(limit)) if limit else texts("class.limit_none")


def _result(memory: Memory, texts: Texts) -> tuple[str, bool | None]:
    """Return the outcome of this page's last request, or why it was not sent, and whether it succeeded (None: open)."""
    refused = refusals.at(memory, (CONTROL,))
    sent = [
        row for row in memory.rows if isinstance(row.request, Govern | SendStop) and row.control == CONTROL
    ]
    if refused is not None and memory.refusal is not None and memory.refusal.outcome.key:
        return refused.text, False
    if not sent:
        return "", None
    text, good = history.result(sent[-1], texts)
    return f"{history.what(sent[-1], texts)}: {text}", good


# -- rows -------------------------------------------------------------------------------------------


def table(world: World, texts: Texts) -> tuple[ClassRowView, ...]:
    """Return a row for each robot."""
    return tuple(_row(robot, world, texts) for robot in world.robots)


def _row(robot: RobotState, world: World, texts: Texts) -> ClassRowView:
    status, found = robot.status, pills.problem(robot, texts) or pills.working(robot, texts)
    place = (robot.robot, robot.side)
    named = f"{robot.robot} ({texts(f'sides.{robot.side}')})"
    freeze = LeaseAction.UNFREEZE if status is not None and status.frozen else LeaseAction.FREEZE
    mine = status is not None and status.holder == world.seat and bool(status.lease)
    take = Govern(NEW, LeaseAction.GIVE_BACK if mine else LeaseAction.TAKE, (place,))
    remarks = _remarks(status, found, texts)
    if status is not None and not (world.account is not None and world.account.of_seat(robot.robot)):
        missing = sorted(_muted(world) - {*status.muted})
        remarks += [texts("class.not_muted", seats=_shown(world, missing))] if missing else []
    return ClassRowView(
        place=place,
        cells=(
            robot.robot,
            texts(f"side.{robot.side}"),
            f"{pills.SYMBOLS[found.condition]} {found.text}",
            _driver(status, world, texts),
            texts("class.turn", seconds=float(status.turn_s)) if status is not None and status.turn_s else "",
            "" if status is None else _shown(world, status.waiting),
            texts("class.rate", hz=float(robot.hz)),
            texts("unknown")
            if robot.positions_age_s is None
            else texts("class.age", seconds=float(robot.positions_age_s)),
            " · ".join(remarks),
        ),
        condition=found.condition,
        details="\n".join(remarks),
        freeze=button(texts, f"class.{freeze.value}", Govern(NEW, freeze, (place,)), robot=named),
        take=button(texts, "class.give_back" if mine else "class.take_over", take, robot=named),
        show=button(texts, "class.show_robot", ChooseRobot(robot.robot), robot=named),
    )


def _remarks(status: Status | None, found: pills.RobotCondition, texts: Texts) -> list[str]:
    """Return facts that the other cells of a row do not show."""
    remarks = [found.reason] if found.condition in (Condition.SILENT, Condition.FAULT) else []
    if status is None:
        return remarks
    if status.frozen and found.condition is not Condition.FROZEN:
        remarks.append(texts("condition.frozen_short"))
    if status.speed_limit:
        remarks.append(limit_text(status, texts))
    return [*remarks, *status.warnings]


def _driver(status: Status | None, world: World, texts: Texts) -> str:
    if status is None or not status.holder:
        return ""
    holder = world.shown(status.holder)
    return texts("class.taken", holder=holder) if status.lease else holder


# -- requests -----------------------------------------------------------------------------------------


def toggle(memory: Memory, world: World, _intent: TogglePage) -> list[Action]:
    """Show the page or hide it; only in the teacher's window."""
    shown = memory.choices.page is WindowPage.CLASS
    if world.is_teacher:
        show(memory, WindowPage.ROBOT if shown else WindowPage.CLASS)
    return []


def show(memory: Memory, page: WindowPage) -> None:
    """Choose the page to show."""
    memory.choices = structs.replace(memory.choices, page=page)


def limit(memory: Memory, world: World, intent: LimitClass) -> list[Action]:
    """Return the action that limits the speed of all robots to the typed number (deg/s); no text ends the limit."""
    text = intent.text.strip().removesuffix("°/s").strip().replace(",", ".")
    try:
        speed = limit_of(float(text)) if text else 0.0
    except (ValueError, WrongUsage):
        return memory.refuse(CONTROL, "cannot.limit", text=intent.text) if world.is_teacher else []
    return govern(memory, world, Govern(NEW, LeaseAction.LIMIT, speed=speed))


def govern(memory: Memory, world: World, intent: Govern) -> list[Action]:
    """Return the action of a lease query to several robots; none if this window is not the teacher's."""
    if not world.is_teacher or offline(memory, world, CONTROL):
        return []
    return begin(memory, world, intent, CONTROL)


def choose_router(memory: Memory, world: World, intent: UseRouter | UseAccount) -> list[Action]:
    """Return the actions of the choice of a router or account; while another one is being checked, it is ignored."""
    if isinstance(intent, UseRouter):
        intent = UseRouter(connecting.completed(intent.address))
    show(memory, WindowPage.ROBOT)  # the next seat may not be the teacher's
    return [] if world.choosing else [intent]


def choose_robot(memory: Memory, world: World, intent: ChooseRobot) -> list[Action]:
    """Return the actions that show the robot of this name and give back the previous one."""
    memory.refusal = None
    given_back: list[Action] = []
    if intent.name != world.robot:
        memory.forget_arms()
        given_back = leases.give_back_all(memory, world)
    show(memory, WindowPage.ROBOT)
    return [*given_back, intent]


HANDLES: Handles = {
    TogglePage: toggle,
    Govern: govern,
    LimitClass: limit,
    UseRouter: choose_router,
    UseAccount: choose_router,
    ChooseRobot: choose_robot,
}
