"""The first run: four steps and three missions, which notice when they are done."""

from __future__ import annotations

from collections import defaultdict, deque
from typing import Final

from beatrix_zenoh.contract.names import SIDES
from gui.console.state.actions import Action, Send, SendStop
from gui.console.state.intents import Intent, WindowPage
from gui.console.state.memory import Memory, RequestRow
from gui.console.state.pills import problem
from gui.console.state.sending import PAD, REASONS
from gui.console.state.views import BannerView, button
from gui.console.state.world import World, online

STEPS: Final = ("ready", "drag", "send", "stop")
MISSIONS: Final = ("no", "edge", "lead")
TASKS: Final = (*STEPS, *MISSIONS)
AIMED_DEG: Final = 3.0
"""How far a target differs from the head, in one axis, so that it counts as dragged."""
SIDE_DEG: Final = 5.0
"""How far a head turns to one side (yaw), so that it counts."""
SWINGS, SWINGS_S = 3, 6.0
"""How many turns to alternate sides say no, and in which time (s)."""


class SkipTask(Intent, frozen=True):
    """Go on to the next step or mission."""


class CloseGuide(Intent, frozen=True):
    """End steps and missions for good."""


class Guide:
    """Which step or mission is shown; used like `Memory`, in one thread."""

    def __init__(self, done: int) -> None:
        """Begin after `done` of TASKS."""
        self.done = done
        self._since = 0
        """row of the newest request when the task began"""
        self._praise = False
        self._turns: defaultdict[str, deque[tuple[bool, float]]] = defaultdict(lambda: deque(maxlen=SWINGS))
        """by robot: whether its head turned to the left or right, in turn, and when (monotonic clock, s)"""

    def follow(self, memory: Memory, world: World) -> None:
        """Go on to the next task if the robots, or the outcomes of requests, show that the present one is done."""
        if self.done == len(TASKS):
            return
        for side in () if world.playing else SIDES:  # a gesture is no solution
            if online(world, side) and (seen := world.side(side).reading) is not None:
                self._note_turn(self._turns[side], seen.head.yaw, world.now_s)
        task = TASKS[self.done]
        if self._is_done(task, memory, world):
            self._praise = True
            self.done += 1
            if task != "drag":  # with Send on release, the target is sent while it is dragged
                self._begin(memory)

    @staticmethod
    def _note_turn(turns: deque[tuple[bool, float]], yaw: float, now_s: float) -> None:
        left = yaw > 0
        if abs(yaw) >= SIDE_DEG and (not turns or left is not turns[-1][0]):
            turns.append((left, now_s))

    def handle(self, memory: Memory, _world: World, intent: SkipTask | CloseGuide) -> list[Action]:
        """Go on to the next task, or end."""
        self._praise = False
        self.done = len(TASKS) if isinstance(intent, CloseGuide) else min(self.done + 1, len(TASKS))
        self._begin(memory)
        return []

    def view(self, memory: Memory, world: World) -> BannerView | None:
        """Return the present task with its buttons; None if there is none, and for a teacher."""
        texts, ended = memory.choices.texts, self.done == len(TASKS)
        hidden = world.is_teacher or memory.choices.page is WindowPage.CLASS
        if hidden or (ended and not self._praise):
            return None
        close = button(texts, "guide.close", CloseGuide())
        if ended:
            return BannerView(texts("guide.all_done"), (close,))
        task = TASKS[self.done]
        key, among = ("guide.a_step", STEPS) if task in STEPS else ("guide.a_mission", MISSIONS)
        slots = {"number": among.index(task) + 1.0, "count": float(len(among))}
        text = texts(key, text=texts(f"guide.{task}"), **slots)
        skip = button(texts, "guide.skip", SkipTask())
        return BannerView(texts("guide.well_done", text=text) if self._praise else text, (skip, close))

    def _begin(self, memory: Memory) -> None:
        self._since, memory.lead_beaten = memory.numbers, False
        self._turns.clear()

    def _is_done(self, task: str, memory: Memory, world: World) -> bool:
        rows = [row for row in memory.rows if row.number > self._since]
        match task:
            case "ready":
                texts = memory.choices.texts
                done = any(online(world, side) and problem(world.side(side), texts) is None for side in SIDES)
            case "drag":
                done = _is_aimed(memory, world)
            case "send":
                done = any(
                    isinstance(row.request, Send) and row.control == PAD and _is_good(row) for row in rows
                )
            case "stop":
                done = any(isinstance(row.request, SendStop) and _is_accepted(row) for row in rows)
            case "no":
                found = [turns for turns in self._turns.values() if len(turns) == SWINGS]
                done = any(turns[-1][1] - turns[0][1] <= SWINGS_S for turns in found)
            case "edge":
                done = any(outcome.reason in REASONS for row in rows for outcome in row.outcomes.values())
            case _:
                done = memory.lead_beaten
        return done


def _is_aimed(memory: Memory, world: World) -> bool:
    target = memory.choices.target
    heads = [seen.head for side in SIDES if (seen := world.side(side).reading) is not None]
    if target is None or not heads:
        return False
    aim = (target.yaw, target.pitch, target.roll)
    return max(abs(wanted - at) for wanted, at in zip(aim, heads[0], strict=True)) >= AIMED_DEG


def _is_accepted(row: RequestRow) -> bool:
    return any(outcome.accepted for outcome in row.outcomes.values())


def _is_good(row: RequestRow) -> bool:
    return row.ended and all(outcome.accepted for outcome in row.outcomes.values())
