"""The state of a window between intents, and the one way of its requests into the history."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Generic, Never, TypeVar

from msgspec import structs

from beatrix_zenoh.client import Place
from beatrix_zenoh.client.degrees import ArmAngles, head_angles, motion_query, pose_query
from beatrix_zenoh.contract._generated.messages import Head, MotionQuery, PoseQuery
from beatrix_zenoh.contract.errors import BeatrixError, WrongUsage
from beatrix_zenoh.contract.names import SIDES
from gui.console.state import actions
from gui.console.state.actions import NEW, Action, Outcome, Play, Send, SendStop
from gui.console.state.intents import HeadOrientation, Intent
from gui.console.state.saved import Choices, SavedPose
from gui.console.state.views import HistoryRowView
from gui.console.state.world import LinkPhase, Trouble, World, commanded, news, online

T = TypeVar("T")
CHEER = "cheer"
"""The control of a gesture with which the head celebrates: the user has not pressed anything."""
KEPT = 200
"""Largest number of rows of the history."""
Motion = actions.Send | actions.Play | actions.RunBlocks | actions.RunProgram
"""Actions that move robots until they end."""
ToRobots = (
    actions.Send
    | actions.Play
    | actions.RunBlocks
    | actions.SendCommand
    | actions.AskLease
    | actions.MakeReady
)
"""Actions that are sent only if their robots are online."""
Files = actions.WriteFile | actions.KeepGesture | actions.ShareGesture | actions.FetchGestures
Request = ToRobots | actions.RunProgram | actions.SendStop | actions.Govern | Files
"""Actions with a row in the history."""


def sides_of(request: Request) -> tuple[str, ...]:
    """Return the robots that a request is sent to; none for requests to all robots, and to this computer."""
    match request:
        case actions.MakeReady(side=side) | actions.AskLease(side=side):
            return (side,)
        case actions.SendStop(everywhere=everywhere):
            return () if everywhere else SIDES
    return request.sides if isinstance(request, Motion | actions.SendCommand) else ()


@dataclass(frozen=True, eq=False)
class RequestRow:
    """A request of this window, and its outcomes; a change makes another row, so rows are compared by identity."""

    request: Request
    control: str
    """the control of the request: `head`, `short`, `middle`, `long`, `all` or `commands`"""
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
    music: str = ""
    """path of the music beside it; empty: none"""
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
    code: Kept[str] = field(default_factory=Kept)
    details: Mapping[str, Kept[str]] = field(default_factory=lambda: {side: Kept() for side in SIDES})
    """`pills.details` of each side"""

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


Query = MotionQuery | PoseQuery
Handles = Mapping[type[Intent], Callable[[Memory, World, Never], list[Action]]]
"""What a topic does for its intents, by their class; each function takes an intent of that class."""


def pass_on(_memory: Memory, _world: World, action: Action) -> list[Action]:
    """Return an action for which nothing is left to decide; for those that no topic handles."""
    return [action]


def send_arms(
    memory: Memory,
    world: World,
    arms: tuple[float, float, float],
    control: str,
    *,
    relative: bool = False,
    undoes: bool = False,
    sides: tuple[str, ...] | None = None,
) -> list[Action]:
    """Return the action that turns the arms to, or by, angles (deg) at the chosen speed; none if it is refused.

    sides: None: the checked robots
    """
    query = partial(motion_query, *arms, relative=relative, speed=memory.choices.speed)
    chosen = memory.choices.sides if sides is None else sides
    return _send(memory, world, query, control, chosen, undoes=undoes)


def send_head(memory: Memory, world: World, target: HeadOrientation, control: str) -> list[Action]:
    """Return the action that turns the head to an orientation (deg) at the chosen speed; none if it is refused."""
    angles = (target.yaw, target.pitch, target.roll)
    query = partial(pose_query, *angles, relative=False, speed=memory.choices.speed)
    return _send(memory, world, query, control, memory.choices.sides)


def _send(
    memory: Memory,
    world: World,
    query: Callable[[], Query],
    control: str,
    sides: tuple[str, ...],
    *,
    undoes: bool = False,
) -> list[Action]:
    try:
        request = Send(NEW, query(), sides, lead_of(memory, sides))
    except WrongUsage as error:  # a number outside the range of the message
        return memory.refuse_error(control, error)
    return begin(memory, world, request, control, undoes=undoes)


def head_of(query: PoseQuery) -> HeadOrientation:
    """Return the goal of a motion of the head (deg)."""
    return HeadOrientation(*head_angles(Head(query.yaw, query.pitch, query.roll)))


def lead_of(memory: Memory, sides: tuple[str, ...]) -> float:
    """Return the chosen lead (s) if both robots move; else 0."""
    return memory.choices.lead_s if len(sides) > 1 else 0.0


def again(memory: Memory, request: Request) -> Request:
    """Return the request as a new one; a motion goes to the checked robots, with the present lead."""
    if isinstance(request, Send | Play | actions.RunBlocks):
        sides = memory.choices.sides
        return structs.replace(request, row=NEW, sides=sides, lead_s=lead_of(memory, sides))
    return structs.replace(request, row=NEW)


def begin(
    memory: Memory, world: World, request: Request, control: str, *, undoes: bool = False
) -> list[Action]:
    """Number a request, add it to the history and return its action; none if it cannot reach its robots."""
    if isinstance(request, ToRobots) and unreachable(memory, world, sides_of(request), control):
        return []
    memory.numbers += 1
    request = structs.replace(request, row=memory.numbers)
    memory.news = news(world)
    looks = isinstance(request, Send) and isinstance(request.query, PoseQuery)
    if isinstance(request, Motion | SendStop) and not looks:
        # The target of the pad is out of date, so it follows the head again.
        memory.choices = structs.replace(memory.choices, target=None)
    return memory.add_row(RequestRow(request, control, world.wall_s, _before(world, request), undoes))


def _before(world: World, request: Request) -> dict[str, ArmAngles]:
    sides = request.sides if isinstance(request, Motion) else ()
    return {side: arms for side in sides if (arms := commanded(world, (side,))) is not None}
