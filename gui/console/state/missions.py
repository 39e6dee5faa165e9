"""The strip below the header: four steps, eight missions, which notice when they are done, and then the lessons."""

from __future__ import annotations

import math
from collections import defaultdict, deque
from dataclasses import replace
from typing import Final

from beatrix_zenoh.client.degrees import Reading
from beatrix_zenoh.contract.names import SIDES
from gui.console.state.actions import NEW, POSES, Action, Play, Send, SendStop
from gui.console.state.intents import HeadOrientation, Intent, WindowPage
from gui.console.state.lesson_strip import MARKS, LessonStrip, OpenLesson, ShowSheet
from gui.console.state.memory import CHEER, Memory, Motion, RequestRow, begin
from gui.console.state.pills import finding, problem
from gui.console.state.sending import PAD, REASONS
from gui.console.state.views import ButtonView, Condition, StripView, button
from gui.console.state.world import World, online
from gui.console.texts import Texts

STEPS: Final = ("ready", "drag", "send", "stop")
MISSIONS: Final = ("no", "edge", "lead", "hm", "arm", "sleepy", "circle", "dance")
TASKS: Final = (*STEPS, *MISSIONS)
NOT_SIMPLE: Final = ("lead", "arm", "sleepy", "dance")
"""Missions whose controls the simple window hides."""
AIMED_DEG: Final = 3.0
"""How far a target differs from the head, in one axis, so that it counts as dragged."""
CLOSED: Final = 50
"""Is added to the number of done tasks while nothing is shown."""
PRAISE_S: Final = 3.0
"""How long the praise for a task is shown before the next one."""
DANCE: Final = 3
"""Poses of a dance."""
CHEER_S: Final = 0.5, 3.0
"""When (s) after a task the head may celebrate it: a program of the user moves it again before that."""
SIDE_DEG: Final = 5.0
"""How far a head turns to one side (yaw), so that it counts."""
SWINGS, SWINGS_S = 3, 6.0
"""How many turns to alternate sides say no, and in which time (s)."""
EAR_DEG, BESIDE_DEG = 15.0, 6.0
"""How far an ear sinks, and how far the head turns and nods at most meanwhile."""
ARM_DEG, REST_DEG = 20.0, 3.0
"""How far one arm turns, and the two others at most."""
AWAKE_DEG, ASLEEP_DEG, SLOWLY_S = 5.0, 20.0, 3.0
"""From which pitch to which one a head falls asleep, and in which time (s) at least: three quarters of 20 deg in 4 s."""
ROUND_DEG, ROUND_S = 8.0, 20.0
"""How far from straight ahead a circle is, and its longest time (s)."""


class SkipTask(Intent, frozen=True):
    """Go on to the next step or mission."""


class CloseGuide(Intent, frozen=True):
    """Hide the strip for good."""


class OpenGuide(Intent, frozen=True):
    """Show the strip again: the next task, or the lessons."""


class ResumeGuide(Intent, frozen=True):
    """Go on where the strip was closed."""


class ShowHint(Intent, frozen=True):
    """Show the hint of the present mission."""


HANDLED: Final = (SkipTask, CloseGuide, OpenGuide, ResumeGuide, ShowHint, OpenLesson, ShowSheet)


class SeenMoves:
    """What one robot has done since the present mission began; angles in degrees, times on the monotonic clock (s)."""

    def __init__(self) -> None:
        self._turns: deque[tuple[bool, float]] = deque(maxlen=SWINGS)
        """whether its head turned to the left or right, in turn, and when"""
        self._quarters: deque[tuple[int, float]] = deque(maxlen=5)
        """to which quarter its nose pointed, in turn, and when"""
        self._awake_s, self._fall_s = math.inf, 0.0
        """when the nose was up last, and how long it sank from then"""
        self._all: tuple[float, ...] = ()

    def note(self, now: Reading, now_s: float) -> None:
        """Note what the robot does now."""
        yaw, pitch, roll = now.head
        self._all = yaw, pitch, roll, *now.arms
        if abs(yaw) >= SIDE_DEG and (not self._turns or (yaw > 0) is not self._turns[-1][0]):
            self._turns.append((yaw > 0, now_s))
        quarter = math.floor(math.atan2(pitch, yaw) / (math.pi / 2) + 0.5) % 4
        away = math.hypot(yaw, pitch) >= ROUND_DEG
        if away and (not self._quarters or quarter != self._quarters[-1][0]):
            self._quarters.append((quarter, now_s))
        if pitch < AWAKE_DEG:
            self._awake_s, self._fall_s = now_s, 0.0
        elif pitch >= ASLEEP_DEG and not self._fall_s:
            self._fall_s = max(now_s - self._awake_s, 0.1)

    def does(self, task: str) -> bool:
        """Return whether the robot has just done a mission."""
        if not self._all:
            return False
        done = False
        yaw, pitch, roll, *arms = self._all
        turns, quarters, lowest = self._turns, self._quarters, sorted(map(abs, arms))
        match task:
            case "no":
                done = len(turns) == SWINGS and turns[-1][1] - turns[0][1] <= SWINGS_S
            case "hm":
                done = abs(roll) >= EAR_DEG and max(abs(yaw), abs(pitch)) <= BESIDE_DEG
            case "arm":
                done = lowest[2] >= ARM_DEG and lowest[1] <= REST_DEG
            case "sleepy":
                done = self._fall_s >= SLOWLY_S
            case "circle":
                ways = {(b[0] - a[0]) % 4 for a, b in zip(quarters, [*quarters][1:], strict=False)}
                full = len(quarters) == quarters.maxlen and len(ways & {1, 3}) == len(ways) == 1
                done = full and quarters[-1][1] - quarters[0][1] <= ROUND_S
        return done


class Guide:
    """Which step or mission is shown; used like `Memory`, in one thread."""

    def __init__(self, done: int) -> None:
        """Begin after `done` of TASKS."""
        self.done = done
        self._since = 0
        """row of the newest request when the task began"""
        self._hint = False
        self._done_s = -PRAISE_S
        """when the last task was done (monotonic clock, s)"""
        self._cheer_s = -CHEER_S[1]
        """when something was done (monotonic clock, s)"""
        self._seen: defaultdict[str, SeenMoves] = defaultdict(SeenMoves)
        """by side"""
        self._lessons = LessonStrip()
        self._reads = False
        """whether lessons are shown before all tasks are done"""

    def follow(self, memory: Memory, world: World) -> None:
        """Go on to the next task if the robots, or the outcomes of requests, show that the present one is done."""
        if self._lessons.passes(world):
            self._cheer_s = world.now_s
        if self.done >= len(TASKS) or self._reads:
            return
        alone = world.account is not None and not online(world, "hw")  # the own head of a seat of a class
        sends = memory.choices.simple  # when the drag ends
        if TASKS[self.done] in (*(("lead",) if alone else ()), *(("send",) if sends else ())):
            self.done += 1
        # None of them is a solution.
        others_move = world.playing or world.block is not None or world.program.running
        for side in () if others_move else SIDES:
            status, seen = world.side(side).status, world.side(side).reading
            own = status is None or status.holder in ("", world.seat)
            if own and online(world, side) and seen is not None:
                self._seen[side].note(seen, world.now_s)
        task = TASKS[self.done]
        if self._is_done(task, memory, world):
            self._done_s = world.now_s
            if memory.rows:  # otherwise another seat has done it, for example by making the robot ready
                self._cheer_s = world.now_s
            self.done += 1
            if task != "drag":  # with Send on release, the target is sent while it is dragged
                self._begin(memory)

    def celebration(self, memory: Memory, world: World) -> list[Action]:
        """Return the gesture of the simulated head, if something was just done and the user lets it rest."""
        if world.is_teacher or not CHEER_S[0] <= world.now_s - self._cheer_s <= CHEER_S[1]:
            return []
        newest, texts = memory.rows[-1] if memory.rows else None, memory.choices.texts
        moves = world.plan or world.playing or world.block is not None or world.program.running
        held = memory.open_hold or (memory.live_row or 0) > 0
        waits = held or memory.choices.target or any(_is_open(row) for row in memory.rows)
        stopped = newest is not None and isinstance(newest.request, SendStop)
        if moves or waits or stopped or finding(world, "sim", texts).condition is not Condition.READY:
            return []
        self._cheer_s = -CHEER_S[1]
        return begin(
            memory, world, Play(NEW, ("sim",), gesture="dance" if self.done == len(TASKS) else "yes"), CHEER
        )

    def handle(self, memory: Memory, world: World, intent: Intent) -> list[Action]:
        """Carry out an intent of HANDLED."""
        self._done_s = -PRAISE_S
        match intent:
            case OpenLesson() | ShowSheet():
                self._reads = self._reads or isinstance(intent, OpenLesson)
                return self._lessons.handle(memory, world, intent)
            case ShowHint():
                self._hint = not self._hint
                return []
            case CloseGuide():
                self.done = CLOSED + min(self.done, len(TASKS))
            case ResumeGuide():
                self.done = min(self.done % CLOSED, len(TASKS))
            case OpenGuide():
                self.done, self._reads = min(self.done % CLOSED, len(TASKS)), False
            case _:
                self.done = min(self.done + 1, len(TASKS))
        self._begin(memory)
        return []

    def view(self, memory: Memory, world: World) -> StripView | None:
        """Return the present task or lesson; None if the strip is closed, and for a teacher."""
        texts = memory.choices.texts
        if world.is_teacher or memory.choices.page is WindowPage.CLASS or self.done > len(TASKS):
            return None
        close = button(texts, "guide.close", CloseGuide())
        reads = self.done == len(TASKS) or self._reads
        strip = (
            self._lessons.view(memory, world, close)
            if reads
            else self._task(texts, close, simple=memory.choices.simple)
        )
        if world.now_s - self._done_s < PRAISE_S:
            strip = replace(strip, text=texts("guide.well_done"), good=True)
        back = (button(texts, "guide.missions", OpenGuide()),) if self.done < len(TASKS) and reads else ()
        page, picture = self._lessons.sheet(memory, world)
        menu = (*back, *self._lessons.menu(memory, world))
        return replace(strip, lessons=menu, page=page, picture=picture)

    def _task(self, texts: Texts, close: ButtonView, *, simple: bool) -> StripView:
        """Return the present step or mission."""
        task = TASKS[self.done]
        key, among = ("guide.a_step", STEPS) if task in STEPS else ("guide.a_mission", MISSIONS)
        at = among.index(task)
        words = texts(f"guide.{task}")
        if simple and task in NOT_SIMPLE:
            words = f"{words} {texts('guide.all')}"
        text = texts(key, text=words, number=at + 1.0, count=float(len(among)))
        hint = button(texts, "guide.hint", ShowHint()) if among is MISSIONS else None
        return StripView(
            text=f"{text}\n{texts(f'guide.hint_{task}')}" if self._hint and hint else text,
            progress=MARKS[True] * at + MARKS[False] * (len(among) - at),
            count=texts("strip.count", done=float(at), count=float(len(among))),
            buttons=(*((hint,) if hint else ()), button(texts, "guide.skip", SkipTask()), close),
        )

    def _begin(self, memory: Memory) -> None:
        self._since, memory.lead_beaten = memory.numbers, False
        self._hint = False
        self._seen.clear()

    def _is_done(self, task: str, memory: Memory, world: World) -> bool:
        rows = [row for row in memory.rows if row.number > self._since]
        done = False
        match task:
            case "ready":
                texts = memory.choices.texts
                done = any(online(world, side) and problem(world.side(side), texts) is None for side in SIDES)
            case "drag":
                done = _is_aimed(memory, world)
            case "send":
                sent = [row for row in rows if isinstance(row.request, Send) and row.control == PAD]
                done = any(row.ended and all(one.accepted for one in row.outcomes.values()) for row in sent)
            case "stop":
                stops = [row for row in rows if isinstance(row.request, SendStop)]
                done = any(outcome.accepted for row in stops for outcome in row.outcomes.values())
            case "edge":
                done = any(outcome.reason in REASONS for row in rows for outcome in row.outcomes.values())
            case "lead":
                done = memory.lead_beaten
            case "dance":
                done = world.playing == POSES and world.playing_pose >= DANCE - 1
        return done or any(seen.does(task) for seen in self._seen.values())


def _is_open(row: RequestRow) -> bool:
    """Return whether a motion still waits or runs, as far as this window knows."""
    return isinstance(row.request, Motion) and not row.ended and not row.dropped


def _is_aimed(memory: Memory, world: World) -> bool:
    target = memory.choices.target
    heads = [seen.head for side in SIDES if (seen := world.side(side).reading) is not None]
    if target is None or not heads:
        return False
    return target.away(HeadOrientation(*heads[0])) >= AIMED_DEG
