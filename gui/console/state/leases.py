"""The lease of each robot: the button that takes the robot, waits for it or gives it back, the notes and the banner."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from beatrix_zenoh.client import Place
from beatrix_zenoh.contract._generated.messages import LeaseAction, Status
from beatrix_zenoh.contract.names import SIDES
from gui.console.state import views
from gui.console.state.actions import NEW, Action, AskLease, Govern
from gui.console.state.intents import DismissNotice
from gui.console.state.memory import Handles, Memory, Notice, begin
from gui.console.state.views import BannerView, ButtonView
from gui.console.state.world import World, online, silent
from gui.console.texts import Texts

CONTROL: Final = "commands"


def button(world: World, side: str, texts: Texts) -> ButtonView | None:
    """Return the button of one robot's lease; None if the robot does not answer."""
    robot = world.side(side)
    status = robot.status
    if not online(world, side) or silent(robot) or status is None:
        return None
    others = status.holder not in ("", world.seat)
    if status.holder == world.seat and status.lease:
        key, action = "give_back", LeaseAction.GIVE_BACK
    elif world.seat in status.waiting:
        key, action = "leave", LeaseAction.GIVE_BACK
    elif others and not world.is_teacher:
        key, action = "wait", LeaseAction.WAIT
    else:
        key, action = "take_over" if others else "take", LeaseAction.TAKE
    return views.button(texts, f"lease.{key}", AskLease(action, side), holder=status.holder)


def notes(status: Status, world: World, texts: Texts, *, holder_shown: bool) -> tuple[str, ...]:
    """Return the holder (unless it is shown already), the waiting seats and the teacher's settings, in a few words."""
    found = []
    if status.holder and not holder_shown:
        key = "yours" if status.holder == world.seat else "of"
        kind = "taken" if status.lease else "driven"
        found.append(texts(f"note.{kind}_{key}", holder=status.holder))
    if world.seat in status.waiting:
        place = float(status.waiting.index(world.seat) + 1)
        found.append(texts("note.turn", place=place, count=float(len(status.waiting))))
    elif status.waiting:
        found.append(texts("note.waiting", count=float(len(status.waiting))))
    if status.turn_s:
        found.append(texts("note.turn_left", seconds=float(status.turn_s)))
    if status.speed_limit:
        found.append(limit_text(status, texts))
    return tuple(found)


def limit_text(status: Status, texts: Texts) -> str:
    """Return the speed limit that the teacher has set."""
    return texts("note.limit", speed=math.degrees(status.speed_limit))


# -- changes of leases ------------------------------------------------------------------------------


def follow(memory: Memory, world: World) -> None:
    """Compare the leases of this seat with those at the last call.

    Store a notice about a lease that this seat gained or lost.
    """
    kept: dict[Place, str] = {}
    for side in SIDES:
        place, status = (world.robot, side), world.side(side).status
        kept[place] = before = memory.standings.get(place, "")
        if status is not None and online(world, side):
            kept[place] = now = standing(status, world.seat)
            if now != before:
                memory.lease_notice = _notice(memory, before, now, Notice("", *place, status.holder))
    memory.standings = kept


def standing(status: Status, seat: str) -> str:
    """Return `held` if a seat has taken a robot, `waiting` if it waits for it; else an empty string."""
    if status.holder == seat and status.lease > 0:
        return "held"
    return "waiting" if seat in status.waiting else ""


def _notice(memory: Memory, before: str, now: str, notice: Notice) -> Notice | None:
    if now == "held" and before == "waiting":
        return replace(notice, key="lease.turn")
    last = _last_request(memory, notice.side)
    if before == "held" and not (last and last.action is LeaseAction.GIVE_BACK):
        return replace(notice, key="lease.lost" if notice.holder else "lease.ended")
    return None


def _last_request(memory: Memory, side: str) -> AskLease | None:
    """Return the newest lease query of this window to a robot."""
    sent = (row.request for row in reversed(memory.rows))
    return next((found for found in sent if isinstance(found, AskLease) and found.side == side), None)


def banner(memory: Memory, world: World) -> BannerView | None:
    """Return the banner about a lease that was gained or lost, or about a frozen robot; None if there is neither."""
    texts, notice = memory.choices.texts, memory.lease_notice
    if notice is not None and notice.robot == world.robot:
        slots = {"robot": notice.robot, "holder": notice.holder, "side": texts(f"sides.{notice.side}")}
        close = views.button(texts, "lease.dismiss", DismissNotice())
        return BannerView(texts(notice.key, **slots), (close,))
    frozen = tuple(side for side in SIDES if _is_frozen(world, side))
    if frozen and not world.is_teacher:
        robots = texts("sides.both" if len(frozen) > 1 else f"sides.{frozen[0]}")
        return BannerView(texts("banner.frozen", robots=robots))
    return None


def _is_frozen(world: World, side: str) -> bool:
    status = world.side(side).status
    return online(world, side) and status is not None and status.frozen


# -- requests -----------------------------------------------------------------------------------------


def ask(memory: Memory, world: World, intent: AskLease) -> list[Action]:
    """Hide the notice and return the action of a lease query; none if the robot is unreachable."""
    begun = begin(memory, world, intent, CONTROL)
    memory.lease_notice = None if begun else memory.lease_notice
    return begun


def dismiss(memory: Memory, _world: World, _intent: DismissNotice) -> list[Action]:
    """Hide the notice."""
    memory.lease_notice = None
    return []


def give_back_all(memory: Memory, world: World) -> list[Action]:
    """Clear the leases; return the action that gives back all robots that this window has taken or waits for."""
    places = tuple(
        place
        for place, now in memory.standings.items()
        if now and _last_request(memory, place[1]) is not None
    )
    memory.standings, memory.lease_notice = {}, None
    if not places:
        return []
    return begin(memory, world, Govern(NEW, LeaseAction.GIVE_BACK, places), CONTROL)


HANDLES: Handles = {AskLease: ask, DismissNotice: dismiss}
