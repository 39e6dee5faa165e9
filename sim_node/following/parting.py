"""Finds out that hardware and simulation are in different places although both have the same set points. No I/O."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms

ARM_APART: Final = math.radians(0.5)
"""Allowed distance (rad) of two arms at rest, less than a full step of a motor (0.69 deg)."""
HEAD_APART: Final = math.radians(1.0)
"""Allowed distance (rad) of two heads at rest in yaw, pitch and roll; near the limit of the tilt 0.5 deg of an arm make
up to twice as much."""
LATE_S: Final = 0.1
"""Allowed lag (s) in motion: the distance may be larger by the way of this time."""
LASTS_S: Final = 0.5
"""Time (s) for which the places must differ, or agree again."""
SAID_S: Final = 1.0
"""Shortest time (s) between two sentences while the places differ, because each is published with the status."""
TURNED: Final = math.radians(1.5)
"""Turn (rad) since the places agreed, above which its direction is compared."""
STANDS: Final = 0.2
"""An arm that has made less than this share of the other's turn stands still."""
ADVICE: Final = "Stop the hardware and look at it; then calibrate it."


class Places(NamedTuple):
    """Measured angles (rad) and velocities (rad/s) of the arms, and yaw, pitch, roll (rad) of the head."""

    arms: Arms
    velocity: Arms
    head: Arms

    def after(self, by_s: float) -> Places:
        """Return the places after `by_s` (s) at constant velocity; the head stays."""
        (x, y, z), (u, v, w) = self.arms, self.velocity
        return self._replace(arms=(x + u * by_s, y + v * by_s, z + w * by_s))


class Parting:
    """Compares places until they differ, or agree again, for LASTS_S."""

    def __init__(self) -> None:
        self.text = ""
        """how the places differ, as a sentence; empty: they agree"""
        self._agreed: tuple[Places, Places] | None = None
        """the places of simulation and hardware when they last agreed"""
        self._changed_s: float | None = None
        self._said_s = float("-inf")

    def reset(self) -> None:
        """Forget everything, because the set points differ."""
        self.text, self._agreed, self._changed_s = "", None, None

    def compare(self, now_s: float, simulation: Places, hardware: Places) -> None:
        """Compare the places at `now_s` (s, of any clock)."""
        different = describe(simulation, hardware, self._agreed)
        if not different:
            self._agreed = simulation, hardware
        if bool(different) == bool(self.text):
            self._changed_s = None
            if now_s - self._said_s >= SAID_S:
                self.text, self._said_s = different, now_s
            return
        if self._changed_s is None:
            self._changed_s = now_s
        if now_s - self._changed_s >= LASTS_S:
            self.text, self._said_s, self._changed_s = different, now_s, None


def describe(simulation: Places, hardware: Places, agreed: tuple[Places, Places] | None) -> str:
    """Return how the places differ, as a sentence; empty if they agree."""
    fastest = max(map(abs, (*simulation.velocity, *hardware.velocity)))
    allowed = ARM_APART + LATE_S * fastest
    apart = [abs(one - other) for one, other in zip(simulation.arms, hardware.arms, strict=True)]
    arms = [_arm(i, angle, simulation, hardware, agreed) for i, angle in enumerate(apart) if angle > allowed]
    if arms:
        return f"Hardware and simulation have parted: {'; '.join(arms)}. {ADVICE}"
    heads = max(
        abs(math.remainder(one - other, math.tau))
        for one, other in zip(simulation.head, hardware.head, strict=True)
    )
    if heads > HEAD_APART + 2 * LATE_S * fastest:
        return (
            f"Hardware and simulation have parted: their arms agree, but their heads are {math.degrees(heads):.1f}° "
            "apart. Start both with the same robot file; if they have it, look at the rods."
        )
    return ""


def _arm(
    i: int, apart: float, simulation: Places, hardware: Places, agreed: tuple[Places, Places] | None
) -> str:
    """Return the words about one arm of the hardware."""
    words = f"the {ARMS[i]} arm of the hardware"
    angle = f"{math.degrees(apart):.1f}°"
    if agreed is not None:
        here, there = simulation.arms[i] - agreed[0].arms[i], hardware.arms[i] - agreed[1].arms[i]
        if abs(here) > TURNED and abs(there) < STANDS * abs(here):
            return f"{words} stands still, {angle} away"
        if abs(here) > TURNED and here * there < 0:
            return f"{words} turns the other way, {angle} away"
    return f"{words} is {angle} away"
