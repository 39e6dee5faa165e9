"""One open page: its state, the link with which it drives, and the views that its browser gets."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Final

import msgspec

from beatrix_zenoh.contract._generated.messages import LeaseAction
from beatrix_zenoh.contract.names import SIDES
from gui.console.link import Link
from gui.console.state import class_page, intents
from gui.console.state.actions import (
    FOLLOW,
    Action,
    AskLease,
    Hold,
    Outcome,
    SendStop,
)
from gui.console.state.arms import HoldArm, Steer
from gui.console.state.intents import Intent, SaveGesture, Tab
from gui.console.state.own_gestures import DeleteGesture
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.console.state.views import View
from gui.console.state.world import LinkPhase, World, online
from gui.console.texts import Texts
from gui.page import lessons_face, parts
from gui.page.lessons_face import Lessons
from gui.page.messages import DRIVING, OpenProgram, SaveProgram
from gui.page.shelf import Desk

HISTORY: Final = 40
"""Largest number of rows of the history of a page."""
UNREAD_MAX: Final = 20
"""Largest number of unconfirmed views of a browser; it gets no more until it confirms one."""
QUIET_S: Final = 0.5
"""Longest time between two views, even if nothing has changed: the page notices that its server is lost."""


@dataclass
class Driver:
    """What a page has while it drives, or waits for a robot."""

    link: Link
    seat: str
    beat_s: float
    """time of the last heartbeat of the page (monotonic clock, s)"""
    asked: set[str] = field(default_factory=set)
    """the sides whose leases were requested, since they came online"""
    stopped: bool = False
    """whether the robot was stopped because the page is silent or hidden"""
    held_row: int = 0
    """row of the newest held button"""
    overrides: bool = False
    """whether the teacher has taken the robot by steering, until `steered_s` is long ago"""
    steered_s: float = 0.0
    """time of the last request of a stick (monotonic clock, s)"""

    def beat(self) -> None:
        """Record a heartbeat of the page, and clear `stopped`."""
        self.beat_s, self.stopped = time.monotonic(), False


class Face:
    """The state of one page; all methods run on the thread of the server's loop."""

    def __init__(
        self,
        world: World,
        visitor: str,
        send: Callable[[bytes], object],
        close: Callable[[], None],
        stop: Callable[[Face, SendStop], bool],
        desk: Desk,
        lessons: Lessons,
    ) -> None:
        """Begin to watch a robot.

        Args:
            world: the present world of this robot.
            visitor: the name of the browser.
            send: sends a message to the browser.
            close: closes the web socket of the page.
            stop: sends STOP for a page without a session of its own, or in a class; returns whether there is a session.
            desk: the programs of its seat.
            lessons: what its seat has reached in lessons.
        """
        self.robot, self._world = world.robot, world
        self.visitor, self.close, self.desk, self.lessons = visitor, close, desk, lessons
        self.driver: Driver | None = None
        self.link: Link | None = None
        """the page's own link in a class, with the account of its seat, also while it only watches"""
        self.shown = ""
        """the name of the pupil in a class"""
        self.beside = ""
        """the robot that a pupil's page shows beside its own; empty: none"""
        self.valid: Callable[[], object] = lambda: True
        """returns a false value when the browser has to log in again"""
        self.shows_class = False
        self.state = State()
        self._send, self._stop = send, stop
        self._notice: tuple[str, dict[str, str]] = ("", {})
        self.aimed = False
        """whether the robot has been online, and the boxes of simulation and hardware fit to it"""
        self._sent: dict[str, bytes] = {}
        self._unread, self._sent_s = 0, 0.0
        self._changes, self._soon, self._fresh = 0, False, True
        self.open(Saved())

    def change(self, world: World) -> None:
        """Show another robot, with the same choices."""
        self.robot, self._world = world.robot, world
        self.open(self.state.saved)

    def open(self, saved: Saved) -> None:
        """Begin with the choices that the browser has kept."""
        self.state, self.aimed, self._fresh = State(saved), False, True
        self.state.handle(
            intents.Choose("tab", Tab.PLOTS), self._world
        )  # pictures have web sockets of their own

    def show_class(self, *, on: bool) -> None:
        """Show or hide the table of all robots."""
        self.shows_class, self._fresh = on, True

    @property
    def holds(self) -> bool:
        """Whether all its robots online have accepted its seat."""
        states = [self._world.side(side).status for side in SIDES if online(self._world, side)]
        seat = None if self.driver is None else self.driver.seat
        return bool(states) and all(state is not None and state.holder == seat for state in states)

    @property
    def runs_program(self) -> bool:
        """Whether *Follow* or *Listen* runs for this page."""
        return self.own_link is not None and self.own_link.moving.python(time.monotonic()).running

    @property
    def own_link(self) -> Link | None:
        """The link that knows the robots of this page; None: it only watches those of the link that all share."""
        return self.link if self.driver is None else self.driver.link

    def give_back(self) -> None:
        """Give back the robots for which this page has asked."""
        for side in self.driver.asked if self.driver is not None else ():
            self.carry_out(AskLease(LeaseAction.GIVE_BACK, side))

    def renew(self) -> None:
        """Let the next view be sent soon."""
        self._fresh = True

    def notify(self, key: str, **slots: str) -> None:
        """Show a sentence beside the button *Drive*; no key: none."""
        self._notice, self._fresh = (key, slots), True

    # -- what the browser sees ----------------------------------------------------------------------

    def due(self, changes: int, now_s: float) -> bool:
        """Return whether it is time for a view: robots move or have published something else, or QUIET_S has passed.

        Args:
            changes: `Monitor.changes` of the robots.
            now_s: monotonic clock.
        """
        changed = self._fresh or changes != self._changes or self._busy or self._soon
        self._changes, self._fresh = changes, False
        return changed or now_s - self._world.now_s >= QUIET_S

    @property
    def _busy(self) -> bool:
        """Whether robots move for this page, or are about to."""
        return self.driver is not None and self.driver.link.moving.busy

    def show(self, world: World, robots: tuple[str, ...]) -> None:
        """Send the parts of the view that have changed, unless too many earlier ones are unconfirmed."""
        self._world = world
        statuses = (world.side(side).status for side in SIDES)
        moves = any(status is not None and status.moving for status in statuses)
        self._soon = moves or world.phase is not LinkPhase.ONLINE
        self._follow(world)
        if self._unread >= UNREAD_MAX:
            return
        encoded = {name: parts.ENCODER.encode(part) for name, part in self._parts(world, robots).items()}
        changed = {name: part for name, part in encoded.items() if self._sent.get(name) != part}
        if changed or world.now_s - self._sent_s >= QUIET_S:
            self._sent |= changed
            self._sent_s = world.now_s
            self._unread += 1
            self._send(parts.ENCODER.encode({name: msgspec.Raw(part) for name, part in changed.items()}))

    def seen(self) -> None:
        """Count a confirmation of the browser."""
        self._unread = max(0, self._unread - 1)

    def _follow(self, world: World) -> None:
        """Compare leases; ask for each robot that comes online, and check the box of the only robot online."""
        self.state.follow(world)
        here = [side for side in SIDES if online(world, side)]
        if here and not self.aimed:
            self.aimed = True
            self.state.handle(intents.Choose("sim", value="sim" in here), world)
            self.state.handle(intents.Choose("hw", value="sim" not in here), world)
        driver = self.driver
        if driver is not None:
            for action in self.state.celebration(world):
                driver.beat()  # the page hears only now that its robot moves, and that it must beat faster
                self._do(action)
            driver.asked &= set(here)
            for side in here:
                if side not in driver.asked:
                    driver.asked.add(side)
                    asked = LeaseAction.TAKE if driver.overrides else LeaseAction.WAIT
                    self.carry_out(AskLease(asked, side))

    def _parts(self, world: World, robots: tuple[str, ...]) -> dict[str, object]:
        view, driver, texts = self.state.view(world), self.driver, self.state.choices.texts
        key, slots = self._notice
        rows = class_page.table(world, texts) if self.shows_class else ()
        return {
            "online": world.phase is LinkPhase.ONLINE,
            "robots": robots,
            "you": {
                "seat": "" if driver is None else driver.seat,
                "drives": driver is not None,
                "moves": self._busy,
                "name": self.shown,
                "beside": self.beside,
                "text": self._role(world, texts),
                "notice": texts(key, **slots) if key else "",
            },
            "saved": self.state.saved,
            "choices": view.choices,
            "language": texts.code,
            "texts": parts.texts_of_page(texts.code),
            "eyes": self._eyes(view, world),
            "class": [{"cells": row.cells, "condition": row.condition} for row in rows],
            "govern": parts.governing(view.class_page) if self.shows_class else None,
            "empty": class_page.empty(world, texts) if self.shows_class else None,
            "banner": parts.banner(view, world),
            "pills": [parts.pill(pill) for pill in view.pills],
            "head": replace(view.head, path=(), drag=replace(view.head.drag, border=())),
            "border": view.head.drag.border,
            "guide": None if driver is None else parts.guide(view, self.state.saved.guided, texts),
            "gestures": parts.gestures(view.gestures, texts),
            "history": view.history[:HISTORY],
            "programs": self.desk.view,
            "opened": self.desk.opened,
            "lessons": lessons_face.pages(texts.code),
            "studied": self.lessons.states(texts.code),
            "check": self.lessons.check_view,
            **{
                name: getattr(view, name)
                for name in (
                    *("title", "robot", "arms", "sending", "commands", "blocks", "sequence"),
                    *("last", "stop", "emergency"),
                )
            },
        }

    def _role(self, world: World, texts: Texts) -> str:
        """Return whether the page watches, waits or drives, in a sentence."""
        if self.driver is None:
            return texts("page.watch")
        seat, shown = self.driver.seat, self.shown or self.driver.seat
        statuses = [status for side in SIDES if (status := world.side(side).status) is not None]
        waits = any(seat in status.waiting for status in statuses)
        drives = any(status.lease and status.holder == seat for status in statuses)
        return texts("page.waits" if waits and not drives else "page.you", seat=shown)

    def _eyes(self, view: View, world: World) -> dict[str, object]:
        """Return the robot whose pictures the page shows, and why there are none."""
        choices = self.state.choices
        follows = world.program.runs(FOLLOW)
        seeing = world.program.sides[:1] if follows else ()
        sides = sorted(
            SIDES,
            key=lambda side: (side not in seeing, not online(world, side), side not in choices.sides),
        )
        eye = next(eye for eye in view.eyes if (eye.side, eye.eye) == (sides[0], "left"))
        text = (
            "" if eye.text == choices.texts("eye.waiting") else eye.text
        )  # cameras work only while they are watched
        return {"side": sides[0], "on": choices.cameras, "text": text, "follows": follows}

    # -- what the user does -------------------------------------------------------------------------

    def carry_out(self, intent: Intent) -> None:
        """Carry out an intent of the page; if it needs a page that drives and this one does not, show a sentence."""
        if isinstance(intent, DRIVING) and self.driver is None:
            self.notify("page.watching")
            return
        if (
            self.driver is not None
            and isinstance(intent, DRIVING)
            and not isinstance(intent, HoldArm | Steer)
        ):
            self.notify("")
        self._fresh = True
        for action in self.state.handle(intent, self._world):
            self._do(action)

    def _do(self, action: Action) -> None:
        link = self.own_link
        if isinstance(action, SendStop) and self.link is not None:
            self.link.drop()
            if self._stop(self, action):  # not over the router of the seats, which may hang
                return
        if link is not None:
            link.do(action)
        if isinstance(action, Hold) and self.driver is not None and action.row != self.driver.held_row:
            self.driver.held_row = action.row  # a new press, no heartbeat
            self.notify("")
        if isinstance(action, SendStop) and (link is None or self._world.phase is not LinkPhase.ONLINE):
            self._stop(self, action)

    def use_programs(self, request: SaveProgram | OpenProgram) -> None:
        """Keep a program of blocks, or open one."""
        self._fresh = True
        if isinstance(request, SaveProgram):
            self.desk.save(request)
        else:
            self.desk.open(request.name, request.seat)

    def change_gestures(self, intent: SaveGesture | DeleteGesture) -> None:
        """Save the sequence as a gesture of the seat, or delete one."""
        if self.desk.may_save():
            self.carry_out(intent)
        else:
            self.notify("page.program_too_often")

    def report(self, outcome: Outcome) -> None:
        """Show the outcome of a request."""
        self.state.report(outcome)
        self._fresh = True

    def stop_moving(self) -> None:
        """Stop the robots if they move for this page, because the page is silent or hidden."""
        if self.driver is not None and self._busy:
            self.driver.stopped = True
            self.carry_out(intents.Stop())
