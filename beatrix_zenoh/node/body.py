"""What a node needs of its body: the seam between robot and simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from beatrix_zenoh._generated.messages import Fault, PlantStatus
from beatrix_zenoh._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.board.board import Port
from beatrix_zenoh.drive import Arms

PREVIEW_MAX_S = 60.0
"""Longest motion that is tried."""


@dataclass(frozen=True)
class Pose:
    """Where the arms are (rad) and how fast they turn (rad/s)."""

    position: Arms
    velocity: Arms


@dataclass(frozen=True)
class Preview:
    """A motion carried out on a copy: times (s), arms and head (yaw, pitch, roll) in rad."""

    duration_s: float
    tilt_max: float
    gap_min: float
    t: list[float]
    arms: list[Arms]
    head: list[Arms]


class Body(Protocol):
    """A robot's body: a board on a port, and the physics around it."""

    @property
    def twin(self) -> str:
        """`hw` or `sim`."""

    def open_port(self) -> Port:
        """Open the way to the board; OSError or BeatrixError if there is none now."""

    def pose(self, telemetry: Telemetry) -> Pose:
        """Where the arms are: measured if the body can, else as the firmware counts."""

    def straighten(self) -> None:
        """What a person does before calibrating: put the head upright. A robot waits for its person."""

    def preview(self, move: Move | MoveStraight) -> Preview | None:
        """Carry out a motion on a copy; None if this body has no copy."""

    def plant(self) -> PlantStatus | None:
        """State of the physics; None if it is the real one."""

    def fault(self) -> Fault:
        """What is wrong with the body."""

    def close(self) -> None:
        """Stop the physics."""
