"""The banner: the one action that is needed first (find a router, start or choose a robot, reset the latch)."""

from __future__ import annotations

from dataclasses import replace

from beatrix_zenoh.contract._generated.messages import Command, Fault
from gui.console.state import leases
from gui.console.state.intents import ChooseRobot, Retry, RunCommand, StartSimulation
from gui.console.state.memory import Memory
from gui.console.state.pills import fault_of
from gui.console.state.presence import online
from gui.console.state.views import BannerView, ButtonView
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts

CHOICES = 3
"""Largest number of robots that the banner offers; the list of robots contains all."""


def view(memory: Memory, world: World) -> BannerView | None:
    """Return the banner; None if a robot is online, no latch is set, and `leases.banner` has nothing to show."""
    texts = memory.choices.texts
    latched = tuple(side for side in ("sim", "hw") if _is_latched(world, side))
    if latched:
        robots = texts("sides.both" if len(latched) > 1 else f"sides.{latched[0]}")
        return BannerView(
            texts("banner.emergency", robots=robots), tuple(_reset(side, texts) for side in latched)
        )
    if online(world, "sim") or online(world, "hw"):
        return leases.banner(memory, world)
    if world.starting:
        return BannerView(texts("banner.starting"))
    if world.phase is LinkPhase.CONNECTING:
        return BannerView(texts("banner.connecting", endpoint=world.endpoint))
    start = ButtonView(texts("next.start"), texts("next.start_tip"), StartSimulation())
    others = [name for name in world.names if name != world.robot][:CHOICES]
    tooltip = f"{texts('next.retry_tip')} {world.trouble}".strip()
    retry = ButtonView(texts("next.retry"), tooltip, Retry())
    if world.phase is LinkPhase.REFUSED:
        found = BannerView(texts("banner.refused", endpoint=world.endpoint), (retry,))
    elif world.phase is LinkPhase.NO_ROUTER:
        found = BannerView(texts("banner.no_router", endpoint=world.endpoint), (start, retry))
    elif others:
        choose = [_choose(name, texts) for name in others]
        found = BannerView(texts("banner.other_robots", robot=world.robot), (*choose, start))
    else:
        found = BannerView(texts("banner.no_robot"), (start,))
    return replace(found, text=f"{world.child_trouble} {found.text}".strip())


def _is_latched(world: World, side: str) -> bool:
    status = world.side(side).status
    return online(world, side) and status is not None and fault_of(status) is Fault.EMERGENCY


def _reset(side: str, texts: Texts) -> ButtonView:
    text = texts("banner.reset", side=texts(f"sides.{side}"))
    return ButtonView(text, texts("next.reset_tip"), RunCommand(Command.RESET, side=side))


def _choose(name: str, texts: Texts) -> ButtonView:
    return ButtonView(
        texts("banner.choose", robot=name), texts("banner.choose_tip", robot=name), ChooseRobot(name)
    )
