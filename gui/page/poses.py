"""Poses of robots for the pages that show them: small binary messages beside the views, which are text."""

from __future__ import annotations

import itertools
import struct
import time
from asyncio import Future
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.contract.names import SIDES
from gui.page.face import Face

LAYOUT: Final = struct.Struct("<B6f")
"""Number of the side in SIDES, plus 2 of the robot beside; angles of the short, middle and long arm, yaw, pitch, roll of the
head (rad)."""
DIGITS: Final = 4
"""Decimal places of the angles: a robot at rest sends equal messages."""
REST_S: Final = 1.0
"""Time between two messages of a robot at rest."""
Send = Callable[[bytes], Future[None] | None]


def encode(number: int, found: Positions | None) -> bytes:
    """Return the message of a robot; empty if its positions are unknown."""
    if found is None:
        return b""
    arms, head = found.position, found.head
    angles = (arms.x, arms.y, arms.z, head.yaw, head.pitch, head.roll)
    return LAYOUT.pack(number, *(round(angle, DIGITS) + 0.0 for angle in angles))  # never -0.0


@dataclass
class _Shown:
    """What one page has got of each side."""

    send: Send
    sent: list[bytes] = field(default_factory=lambda: [b""] * 2 * len(SIDES))
    sent_s: list[float] = field(default_factory=lambda: [0.0] * 2 * len(SIDES))
    under_way: Future[None] | None = None

    def show(self, number: int, pose: bytes, now_s: float) -> None:
        """Send a pose that is new, or was sent long ago; not while the last one still waits in this computer."""
        waits = self.under_way is not None and not self.under_way.done()
        if not pose or waits or (pose == self.sent[number] and now_s - self.sent_s[number] < REST_S):
            return
        self.sent[number], self.sent_s[number] = pose, now_s
        self.under_way = self.send(pose)


class Poses:
    """Sends poses to pages; its methods run on the thread of the server's loop."""

    def __init__(self, positions: Callable[[str, str], Positions | None]) -> None:
        """Create it without pages; `positions` returns the newest ones of a robot, by name and side."""
        self._positions = positions
        self._pages: dict[Face, _Shown] = {}

    def start(self, face: Face, send: Send) -> None:
        """Begin to send poses to a page; `send` returns what is done when a message has left this computer."""
        self._pages[face] = _Shown(send)

    def end(self, face: Face) -> None:
        """Send no more poses to a page."""
        self._pages.pop(face, None)

    def send(self) -> None:
        """Send each page the poses of its robots; each pose is encoded once for all pages."""
        encoded: dict[tuple[int, str], bytes] = {}
        for face, page in list(self._pages.items()):
            robots = (face.robot, face.beside) if face.beside else (face.robot,)
            for number, (robot, side) in enumerate(itertools.product(robots, SIDES)):
                if (number, robot) not in encoded:
                    encoded[number, robot] = encode(number, self._positions(robot, side))
                page.show(number, encoded[number, robot], time.monotonic())
