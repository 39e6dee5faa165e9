"""The lids and the gaze of a robot that sleeps, because its motors are off. No Qt.

The real head has no lids, and its eyes look straight ahead: so does the picture of every robot that can move.
"""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.body.head_shape import AWAKE, Face

STEP_MS: Final = 100
"""Time between two faces."""
CLOSED, HALF = Face(1.0), Face(0.5)
WAKING: Final = (HALF, HALF, CLOSED, HALF, *(AWAKE,) * 6, CLOSED, AWAKE)
"""The faces of a robot that wakes up: its last motions before it can move."""
ATTENTION: Final = 40
"""Steps after the last movement of the mouse in which a sleeping robot looks there."""
BLINK: Final = 25
"""Steps between two blinks meanwhile."""
FAR_PX: Final = 300.0
"""Distance of the mouse from the head at which the eyes look furthest."""
MOST_UP: Final = 0.5
GAZES: Final = 2
"""Number of gazes from straight ahead to either side: the mesh of each is kept."""


class Lids:
    """The face of one robot; call `step` every STEP_MS while it `moves`."""

    def __init__(self) -> None:
        self.face = AWAKE
        self._asleep = False
        self._waking: list[Face] = []
        self._mouse: tuple[float, float] | None = None
        self._attention = 0

    @property
    def moves(self) -> bool:
        """Whether the face may change."""
        return self._asleep or bool(self._waking)

    @property
    def rests(self) -> bool:
        """Whether the face stays until the mouse moves."""
        return not self._waking and not self._attention

    def show(self, *, asleep: bool) -> None:
        """Close the eyes of a robot that sleeps, and wake it up when it does not any more."""
        if asleep is not self._asleep:
            self._asleep, self._mouse, self._attention = asleep, None, 0
            self._waking = [] if asleep else [*WAKING]
            self.face = CLOSED if asleep else self._waking.pop(0)

    def step(self, left: float, down: float) -> None:
        """Go on, with the mouse at a place (px) from the middle of the head, to the robot's left and down."""
        if self._waking:
            self.face = self._waking.pop(0)
        elif self._asleep:
            moved = self._mouse not in (None, (left, down))
            self._mouse = left, down
            self._attention = ATTENTION if moved else max(0, self._attention - 1)
            shut = not self._attention or self._attention % BLINK == 1
            self.face = CLOSED if shut else Face(0.5, _gaze(left, 1.0), _gaze(-down, MOST_UP))


def _gaze(distance: float, most: float) -> float:
    """Return one of a few gazes to a side, -1 to 1."""
    part = max(-most, min(most, distance / FAR_PX))
    return round(part * GAZES) / GAZES
