"""The state of a window between intents, and refusals of requests that no robot can get."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Generic, TypeVar

from beatrix_zenoh.client import Place
from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import SIDES
from gui.console.state import actions
from gui.console.state.actions import NEW, Action, Outcome
from gui.console.state.saved import Choices, SavedPose
from gui.console.state.views import CodeView, HistoryRowView
from gui.console.state.world import LinkPhase, Trouble, World, online

T = TypeVar("T")
KEPT = 200
"""Largest number of rows of the history."""
Motion = actions.Send | actions.Play | actions.FollowFace
"""Actions that move robots until they end."""
ToRobots = Motion | actions.SendCommand | actions.AskLease | actions.MakeReady
"""Actions that are sent only if their robots are online."""
Request = ToRobots | actions.SendStop | actions.Govern | actions.WriteFile | actions.CopyProgram
"""Actions with a row in the history."""


def sides_of(request: Request) -> tuple[str, ...]:
    """Return the robots that a request is sent to; none for requests to all robots, and to this computer."""
    match request:
        case actions.MakeReady(side=side) | actions.AskLease(side=side):
            return (side,)
        case actions.SendStop(everywhere=everywhere):
            return () if everywhere else SIDES
        case actions.Govern() | actions.WriteFile() | actions.CopyProgram():
            return ()
    return request.sides


@dataclass(frozen=True, eq=False)
class RequestRow:
    """A request of this window, and its outcomes; a change makes another row, so rows are compared by identity."""

    request: Request
    control: str
    """the control of the request, as in `RefusalView`"""
    began_s: float
    """wall clock, since 1970; 0: unknown"""
    before: Mapping[str, ArmAngles]
    """by side: set point of the arms at the time of the request (deg), if it was known and this is a motion"""
    undoes: bool = False
    """whether this request undoes a motion"""
    dropped: str = ""
    """whether this window has ended the request: `stopped`, or `aborted` by Abort or Change; empty: it has not"""
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    """the newest outcome of each robot"""
    accepted: frozenset[str] = frozenset()
    """robots that accepted it"""

    @property
    def number(self) -> int:
        """Number of the row."""
        return self.request.row

    @property
    def sides(self) -> tuple[str, ...]:
        """Robots that the request was sent to."""
        return sides_of(self.request)

    @property
    def ended(self) -> bool:
        """Whether all outcomes were reported."""
        done = {side for side, outcome in self.outcomes.items() if outcome.done}
        return "" in done or (bool(self.sides) and done >= set(self.sides))

    def after(self, outcome: Outcome) -> RequestRow:
        """Return the row with one more outcome."""
        accepted = self.accepted | {outcome.side} if outcome.accepted else self.accepted
        return replace(self, outcomes={**self.outcomes, outcome.side: outcome}, accepted=accepted)


@dataclass(frozen=True)
class Refusal:
    """The shown refusal as data, so that its sentence can be made in the chosen language."""

    control: str
    outcome: Outcome
    """has the key of a text if the window itself refuses"""
    request: Request | None = None
    """the refused request; None: it was not sent"""
    seen: bool = False
    """whether a robot that refused was seen not to be ready since"""


@dataclass(frozen=True)
class Notice:
    """A sentence about a lease, as data."""

    key: str
    robot: str
    side: str
    holder: str


class Kept(Generic[T]):
    """A part of the view that is made again only if that from which it is made has changed: views are frequent."""

    def __init__(self) -> None:
        self._made: tuple[object, T] | None = None

    def get(self, made_from: object, make: Callable[[], T]) -> T:
        """Return the part."""
        if self._made is None or self._made[0] != made_from:
            self._made = made_from, make()
        return self._made[1]


@dataclass
class Memory:
    """State of one window; intents, outcomes and leases change it."""

    choices: Choices
    poses: tuple[SavedPose, ...] = ()
    """the sequence, whose names are unique"""
    sequence_undo: tuple[tuple[SavedPose, ...], ...] = ()
    """the poses before each change, oldest first"""
    begun: tuple[int, tuple[object, ...]] = (0, ())
    """row and content of the newest play of the sequence on the simulation"""
    rehearsed: tuple[object, ...] = ()
    """content of the last play of the sequence on the simulation that went well"""
    rows: tuple[RequestRow, ...] = ()
    """oldest first"""
    numbers: int = 0
    """number of the newest row"""
    refusal: Refusal | None = None
    live_row: int | None = None
    """row of the motions that follow the present drag of the head; None: none, not positive: it has ended, see `sending`"""
    held_row: int | None = None
    """row of the button that is held; None: none, 0: the press was refused"""
    open_hold: int = 0
    """row of the newest hold until its end; 0: none"""
    lead_beaten: bool = False
    """whether Send now, Change or Abort was pressed while the hardware waited, since the present mission began"""
    connecting: bool = False
    """whether the sheet that connects is shown"""
    port_chosen: bool = False
    """whether the user has chosen a port in it"""
    router: tuple[str, str] = ("", "")
    """endpoint and seat of the window at the last call of `connecting.follow`"""
    news: Mapping[str, Trouble | Path] = field(default_factory=dict)
    """`world.news` at the newest request; they are no longer shown"""
    standings: Mapping[Place, str] = field(default_factory=dict)
    """`leases.standing` of both robots of the shown name at the last call of `leases.follow`"""
    lease_notice: Notice | None = None
    """a sentence about a lease that this seat gained or lost; None: nothing new"""
    history: Kept[tuple[HistoryRowView, ...]] = field(default_factory=Kept)
    code: Kept[CodeView] = field(default_factory=Kept)

    def row(self, number: int) -> RequestRow | None:
        """Return the row of this number; None if the history no longer contains it."""
        return next((row for row in self.rows if row.number == number), None)

    def add_row(self, row: RequestRow) -> list[Action]:
        """Add the newest row, hide the refusal, and return the action of the row."""
        self.rows = (*self.rows, row)[-KEPT:]
        self.refusal = None
        return [row.request]

    def mark_dropped(self, how: str = "stopped") -> None:
        """Mark all unfinished requests as stopped or aborted by this window."""
        self.rows = tuple(row if row.ended else replace(row, dropped=how) for row in self.rows)

    def forget_arms(self) -> None:
        """Forget where the arms were before each motion, because they belong to another robot."""
        self.rows = tuple(replace(row, before={}) for row in self.rows)

    def replace_row(self, changed: RequestRow) -> None:
        """Replace the row of the same number."""
        self.rows = tuple(changed if row.number == changed.number else row for row in self.rows)

    def refuse(self, control: str, key: str, **slots: str | float) -> list[Action]:
        """Show why nothing was sent; return an empty list of actions."""
        self.refusal = Refusal(control, Outcome(NEW, "", accepted=False, done=True, key=key, slots=slots))
        return []

    def refuse_error(self, control: str, error: BeatrixError) -> list[Action]:
        """Show the error because of which nothing was sent; return an empty list of actions."""
        why = (error.reason, error.message, error.detail)
        self.refusal = Refusal(control, Outcome(NEW, "", False, True, *why))  # noqa: FBT003  # refused, the end
        return []


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
