"""What a robot does by itself, for the missions that are noticed from its positions."""

from __future__ import annotations

import math
from collections import deque
from typing import Final

from beatrix_zenoh.client.degrees import Reading

SIDE_DEG: Final = 5.0
"""How far a head turns to one side (yaw), so that it counts."""
SWINGS, SWINGS_S = 3, 6.0
"""How many turns to alternate sides say no, and in which time (s)."""
EAR_DEG, BESIDE_DEG = 15.0, 6.0
"""How far an ear sinks, and how far the head turns and nods at most meanwhile."""
ARM_DEG, REST_DEG = 20.0, 3.0
"""How far one arm turns, and the two others at most."""
AWAKE_DEG, ASLEEP_DEG, SLOWLY_S = 5.0, 20.0, 4.0
"""From which pitch to which one a head falls asleep, and in which time (s) at least."""
ROUND_DEG, ROUND_S = 8.0, 20.0
"""How far from straight ahead a circle is, and its longest time (s)."""


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
