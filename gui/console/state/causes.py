"""Hides refusals and failures when their cause goes, for example when the other seat gives the robot back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

from beatrix_zenoh.client import Presence
from beatrix_zenoh.contract._generated.messages import Fault, Reason, Status
from beatrix_zenoh.contract.names import SIDES
from gui.console.state.memory import Memory, Refusal
from gui.console.state.presence import SERVING, apart, online
from gui.console.state.refusals import LEFT, sides_of
from gui.console.state.world import LinkPhase, World

IN_STATUS: Final[Mapping[Reason, Callable[[Status, str], bool]]] = {
    Reason.NOT_ENABLED: lambda status, _: not status.enabled,
    Reason.NOT_CALIBRATED: lambda status, _: not status.calibrated,
    Reason.NOT_HOLDER: lambda status, seat: status.holder not in ("", seat),
    Reason.FROZEN: lambda status, _: status.frozen,
    Reason.MUTED: lambda status, seat: seat in status.muted,
    Reason.EMERGENCY: lambda status, _: status.fault is Fault.EMERGENCY,
    Reason.BOARD_LOST: lambda status, _: status.fault is Fault.BOARD_LOST,
}
"""Whether the status of a robot shows the cause, for this seat."""
IN_WORLD: Final[Mapping[str, Callable[[World], bool]]] = {
    "cannot.router": lambda world: world.phase is not LinkPhase.ONLINE,
    "cannot.refused": lambda world: world.phase is LinkPhase.REFUSED,
    "cannot.sim": lambda world: not online(world, "sim"),
    "cannot.hw": lambda world: not online(world, "hw"),
    LEFT: apart,
}
"""Whether the cause of a refusal of the window itself lasts, by the key of its text."""
NOT_ONLINE: Final = (Reason.NO_SUCH_ROBOT, Reason.NODE_LOST, Reason.NODE_HANGS)


def follow(memory: Memory, world: World) -> None:
    """Hide the shown refusal, and the failure of a program, if the world has shown its cause, and no longer does."""
    failed, refusal = world.child_trouble, memory.refusal
    if failed is not None and failed.key in SERVING:
        if world.sim.presence is not Presence.ONLINE:
            memory.seen_trouble = failed
        elif memory.seen_trouble == failed:
            memory.troubles = {**memory.troubles, "child.trouble": failed}
    if refusal is None:
        return
    if _lasts(refusal, world):
        memory.refusal = replace(refusal, seen=True)
    elif refusal.seen:
        memory.refusal = None
        memory.solved = 0 if refusal.request is None else refusal.request.row


def _lasts(refusal: Refusal, world: World) -> bool:
    if refusal.key:
        return refusal.key in IN_WORLD and IN_WORLD[refusal.key](world)
    if refusal.reason is Reason.NO_ROUTER:
        return world.phase is not LinkPhase.ONLINE
    robots = [world.side(side) for side in sides_of(refusal) or SIDES]
    if refusal.reason in NOT_ONLINE:
        return any(robot.presence is not Presence.ONLINE for robot in robots)
    shows = IN_STATUS.get(refusal.reason)
    return shows is not None and any(
        robot.status is not None and shows(robot.status, world.seat) for robot in robots
    )
