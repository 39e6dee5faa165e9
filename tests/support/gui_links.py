"""The link of a window without a window, and functions that wait for its reports."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Self

from present import present
from robots import until

from beatrix_zenoh.account import Account
from beatrix_zenoh.client import Presence, RobotState
from beatrix_zenoh.client.degrees import pose_query
from beatrix_zenoh.contract._generated.messages import Command, PoseQuery
from beatrix_zenoh.settings import Settings
from gui.console.link import Link
from gui.console.state.actions import Action, MakeReady, Outcome, SendCommand, SendStop
from gui.console.state.world import World

PATIENCE_S = 40.0


def look(yaw: float, speed: float = 60.0) -> PoseQuery:
    """Return a request to turn the head to this yaw (deg) at this speed (deg/s)."""
    return pose_query(yaw, 0.0, 0.0, relative=False, speed=speed)


class Linked:
    """A started link; it is closed at the end of a `with` block."""

    def __init__(
        self,
        endpoint: str,
        robot: str = "bea",
        who: str = "ana",
        *,
        name_given: bool = True,
        account: Account | None = None,
    ) -> None:
        self.outcomes: list[Outcome] = []
        self.pictures: list[tuple[str, str]] = []
        self.link = Link(
            Settings(robot, endpoint, who, account=account),
            self.outcomes.append,
            lambda side, image: self.pictures.append((side, image.eye)),
            name_given=name_given,
        )
        self.link.look()

    @property
    def world(self) -> World:
        """The present world."""
        return self.link.world()

    def do(self, action: Action) -> None:
        """Carry out an action and assert that the call returns within a second."""
        began_s = time.monotonic()
        self.link.do(action)
        assert time.monotonic() - began_s < 1.0, "the call waited"

    def until(self, holds: Callable[[World], bool], what: str, timeout_s: float = PATIENCE_S) -> World:
        """Wait for the first world that fulfils `holds`, and return it."""
        seen: list[World] = []

        def look() -> bool:
            seen[:] = [self.world]
            return holds(seen[0])

        try:
            until(look, what, timeout_s)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{seen[0]}\n{self.outcomes}") from None
        return seen[0]

    def online(self, *sides: str) -> World:
        """Wait until the robots of these sides publish; return the world."""
        return self.until(
            lambda world: (
                all(world.side(side).presence is Presence.ONLINE for side in sides)
                and all(world.side(side).status is not None for side in sides)
            ),
            f"{sides} online",
        )

    def of(self, row: int, side: str | None = None) -> list[Outcome]:
        """Return the outcomes of a row; with `twin` only those of this twin."""
        return [found for found in list(self.outcomes) if found.row == row and side in (None, found.side)]

    def end_of(self, row: int, side: str = "", timeout_s: float = PATIENCE_S) -> Outcome:
        """Wait for the last outcome of a row and twin, and return it."""
        until(lambda: any(found.done for found in self.of(row, side)), f"row {row} {side} ends", timeout_s)
        (last,) = [found for found in self.of(row, side) if found.done]
        return last

    def accepted(self, row: int, side: str = "", timeout_s: float = PATIENCE_S) -> Outcome:
        """Wait for the first outcome of a row and twin; assert that the robot accepted the request; return it."""
        until(lambda: bool(self.of(row, side)), f"row {row} {side} is accepted", timeout_s)
        first = self.of(row, side)[0]
        assert first.accepted, first
        return first

    def close(self) -> None:
        """Close the link, and assert that this takes less than three seconds."""
        began_s = time.monotonic()
        self.link.close()
        assert time.monotonic() - began_s < 3.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def short(world: World, side: str) -> float:
    """Return the commanded angle of the short arm (deg)."""
    return present(world.side(side).reading).commanded.short


def at_home(linked: Linked) -> None:
    """Stop both robots, make them ready, and wait until all their commanded angles are 0."""
    linked.outcomes.clear()
    linked.online("sim", "hw")
    linked.do(SendStop(-1))
    for side in ("sim", "hw"):
        linked.end_of(-1, side)
        linked.do(SendCommand(-2, Command.ENABLE, value=False, sides=(side,)))
        linked.do(MakeReady(side, -3))
    for side in ("sim", "hw"):
        assert linked.end_of(-3, side).accepted
        linked.until(lambda world, side=side: is_home(world.side(side)), f"{side} at home")  # type: ignore[misc]


def is_home(state: RobotState) -> bool:
    """Return whether a robot is calibrated and all its commanded angles are 0."""
    if state.status is None or state.reading is None:
        return False
    return state.status.calibrated and state.reading.commanded == (0, 0, 0)


def rests(world: World, side: str) -> bool:
    """Return whether a robot says that nothing moves."""
    status = world.side(side).status
    return status is not None and not status.moving
