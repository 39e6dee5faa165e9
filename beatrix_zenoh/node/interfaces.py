"""The interfaces of a node: to its components, and to its robot, which hardware and simulation implement."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import Protocol

from msgspec import Struct

from beatrix_zenoh.board.state import Port
from beatrix_zenoh.board.virtual import TimedPort
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Fault, PlantStatus
from beatrix_zenoh.contract._generated.serial import Telemetry
from beatrix_zenoh.motion.gear import Arms


@dataclass
class StatusFields:
    """Fields of a Status under construction; `warnings` are sentences for the user, the most important first."""

    values: dict[str, object] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    lists: defaultdict[str, list[Struct]] = field(default_factory=lambda: defaultdict(list))
    """by field: the states of sensors of which a robot has several"""


class Component(Protocol):
    """A part of a node; overrides the methods that it needs. Its constructor starts no thread and does not wait.

    A node starts its components in the order of its list and closes them in reverse order. A new component needs a
    file, a line in `node.components`, and rows in schemas for its publications and queries.
    """

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        """Start threads and declare keys."""
        return

    def contribute(self, status: StatusFields) -> None:  # noqa: ARG002
        """Add fields and warnings to a status; several threads call it, so it must be thread-safe and must not wait."""
        return

    def close(self) -> None:
        """End threads and reply to every open request; called even if `start` has failed.

        The node undeclares the keys later.
        """
        return


@dataclass(frozen=True)
class ArmState:
    """Angles (rad) and velocities (rad/s) of the arms at one time, and the firmware's step counters."""

    t_mono_ns: int
    """monotonic clock of this computer at that time"""
    position: Arms
    velocity: Arms
    steps: tuple[int, int, int]
    head: Arms | None = None
    """yaw, pitch, roll (rad) if the robot measures them"""


class HardwareInterface(Protocol):
    """A robot: a board on a port, with real or simulated physics. A subclass overrides what it has."""

    @property
    def side(self) -> str:
        """`hw` or `sim`."""

    @property
    def sampling_s(self) -> float:
        """Time (s) between two samples of the positions: the steps of time stamps."""

    def open_port(self) -> Port:
        """Open the port of the board; raises OSError or BeatrixError if that is not possible now."""

    def timed_port(self) -> TimedPort | None:
        """Return the port of a virtual board, whose time passes from now on in turns; None for a real board."""
        return None

    def pose(self, telemetry: Telemetry, t_mono_ns: int) -> ArmState:
        """Return the pose of the arms: measured if possible, else from the telemetry, which is of `t_mono_ns`."""

    def straighten(self) -> None:
        """Set a simulated head upright before calibration; on hardware a person does this."""
        return

    def plant(self) -> PlantStatus | None:
        """Return the state of the simulated physics; None for hardware."""
        return None

    def fault(self) -> Fault:
        """Return the fault of the robot other than a fault of its board."""
        return Fault.NONE

    def close(self) -> None:
        """Stop the simulated physics or the virtual board, if there is one."""
        return
