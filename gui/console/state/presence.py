"""Reachability and position of robots."""

from __future__ import annotations

from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles, Reading
from gui.console.state.intents import HeadOrientation
from gui.console.state.memory import Memory
from gui.console.state.world import LinkPhase, Trouble, World

FURTHEST_DEG = 1e4
"""larger angles (deg) do not come from a robot and are ignored"""
APART_DEG = 1.0
"""difference of an angle (deg) above which both robots are apart; at one place they differ by less"""
STALE_S = 0.4
"""A robot whose newest positions are older than this (s) is silent; robots publish positions every 20 ms."""

SERVING = ("trouble.router", "trouble.simulation")
"""Failures that are over when a simulation is online."""


def online(world: World, side: str) -> bool:
    """Return whether a request can reach a robot: there is a router, and the robot's token."""
    return world.phase is LinkPhase.ONLINE and world.side(side).presence is not Presence.ABSENT


def silent(robot: RobotState) -> bool:
    """Return whether the positions or the status of the robot are missing or too old."""
    age_s = robot.positions_age_s
    return robot.status is None or robot.positions is None or age_s is None or age_s > STALE_S


def kept(world: World, side: str) -> Reading | None:
    """Return the last angles (deg) of a robot that is online, even if they are old; None if they are unknown."""
    found = world.side(side).reading if online(world, side) else None
    angles = () if found is None else (*found.arms, *found.commanded, *found.head)
    return found if all(abs(angle) < FURTHEST_DEG for angle in angles) else None


def reading(world: World, side: str) -> Reading | None:
    """Return the angles of a robot in degrees; None if they are unknown or too old."""
    return None if silent(world.side(side)) else kept(world, side)


def commanded(world: World, sides: tuple[str, ...]) -> ArmAngles | None:
    """Return the set point of the arms (deg) of the first robot that reports it; None if none does."""
    for side in sides:
        if (found := reading(world, side)) is not None:
            return found.commanded
    return None


def apart(world: World) -> bool:
    """Return whether both robots rest, and their arms stand at different angles."""
    sim, hw = reading(world, "sim"), reading(world, "hw")
    statuses = (world.sim.status, world.hw.status)
    if sim is None or hw is None or any(status is None or status.moving for status in statuses):
        return False
    return any(abs(one - other) > APART_DEG for one, other in zip(sim.arms, hw.arms, strict=True))


def orientation(head: HeadAngles) -> HeadOrientation:
    """Return head angles as an orientation of a view."""
    return HeadOrientation(*head)


def troubles(world: World) -> dict[str, Trouble | None]:
    """Return the failures of recording and child programs by the key of their text; None: no failure."""
    recording = None if world.recording is None else world.recording.trouble
    return {"record.trouble": recording, "child.trouble": world.child_trouble}


def offline(memory: Memory, world: World, control: str) -> bool:
    """Return whether there is no router; if so, show why the request cannot be sent."""
    if world.phase is LinkPhase.ONLINE:
        return False
    key = "cannot.refused" if world.phase is LinkPhase.REFUSED else "cannot.router"
    memory.refuse(control, key, endpoint=world.endpoint)
    return True


def unreachable(memory: Memory, world: World, sides: tuple[str, ...], control: str) -> bool:
    """Return whether a request to these robots cannot be sent; if so, show why."""
    if not sides:
        memory.refuse(control, "off.unchecked")
    elif offline(memory, world, control):
        pass
    elif absent := [side for side in sides if not online(world, side)]:
        key = "cannot.sim" if absent[0] == "sim" else "cannot.hw"
        memory.refuse(control, key, robot=world.robot)
    else:
        return False
    return True
