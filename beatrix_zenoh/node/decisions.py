"""What the teacher has decided about a robot, kept in a file, so that a restart of the node does not undo it."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Annotated, Final

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused, WrongUsage, wrong_usage
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.interfaces import Component, StatusFields
from beatrix_zenoh.node.leases import LONGEST_TURN_S, SHORTEST_TURN_S, TURN_S

LONGEST: Final = 64 * 1024
"""Largest size of the file (bytes)."""


class Decisions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The decisions of the teacher; the file has only those that differ from these defaults."""

    frozen: bool = False
    muted: list[str] = []
    speed_limit_deg_s: float = 0.0
    """0: none"""
    teacher_latch: bool = False
    """whether the teacher has pressed EMERGENCY_STOP"""
    turn_s: Annotated[float, msgspec.Meta(ge=SHORTEST_TURN_S, le=LONGEST_TURN_S)] = TURN_S
    """length of a turn while seats wait"""


def read(path: Path) -> Decisions:
    """Return the decisions in a file; if there is none, the defaults.

    Raises:
        OSError: the file cannot be read.
        WrongUsage: BAD_VALUE, its content is not valid.
    """
    if not path.exists():
        return Decisions()
    table = files.toml(path, LONGEST)
    if not table:
        raise wrong_usage(f"{path} is empty.")
    try:
        kept = msgspec.convert(table, Decisions)
    except msgspec.ValidationError as error:
        raise wrong_usage(f"{path} is not valid: {error}.") from error
    for seat in kept.muted:
        if names.check_seat(seat) == names.TEACHER:
            raise wrong_usage(f"{path} is not valid: the teacher cannot be muted.")
    return kept


def write(path: Path, decisions: Decisions) -> None:
    """Write the decisions, or remove the file if all are the defaults; raises OSError."""
    defaults = msgspec.structs.asdict(Decisions())
    table = {
        name: value for name, value in msgspec.structs.asdict(decisions).items() if value != defaults[name]
    }
    if not table:
        path.unlink(missing_ok=True)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    files.write_private(path, files.toml_text(table))


class TeacherDecisions(Component):
    """Restores the decisions of the teacher at the start of a node, and keeps later ones in the file at `path`.

    Without a path nothing is kept. A file that cannot be read freezes the robot: it exists only if the teacher has
    decided something, and freezing is the decision that the teacher can lift without harm.
    """

    def __init__(self, controller: MotionController, path: Path | None) -> None:
        self._access, self._planner = controller.access, controller.planner
        self._diagnostics, self._path = controller.diagnostics, path
        self._kept = Decisions()

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        if self._path is None:
            return
        access = self._access
        try:
            kept = read(self._path)
            self._planner.limit_speed(math.radians(kept.speed_limit_deg_s))
        except (OSError, WrongUsage, Refused) as error:
            kept = Decisions(frozen=True)
            reason = error.message if isinstance(error, BeatrixError) else f"{error}."
            self._diagnostics.warn(
                f"The teacher's decisions about this robot, in {self._path}, cannot be read, so the robot is frozen until "
                f"the teacher types `beatrix unfreeze`. {reason}",
                Reason.FROZEN,
            )
        with access.lock:
            access.teacher.frozen, access.teacher.muted = kept.frozen, frozenset(kept.muted)
            access.lease.turn.limit_s = kept.turn_s
            if kept.teacher_latch:
                access.latch(time.monotonic(), teacher=True)
        self._kept = kept

    def contribute(self, status: StatusFields) -> None:
        access = self._access
        with access.lock:
            status.values["frozen"] = access.teacher.frozen
            status.values["muted"] = sorted(access.teacher.muted)
            status.values["teacher_latch"] = access.teacher.latch
        status.values["speed_limit"] = self._planner.speed_limit

    def keep(self) -> None:
        """Write the present decisions if they have changed; called on the controller's thread."""
        access = self._access
        with access.lock:
            now = Decisions(
                frozen=access.teacher.frozen,
                muted=sorted(access.teacher.muted),
                speed_limit_deg_s=round(math.degrees(self._planner.speed_limit), 3),
                teacher_latch=access.teacher.latch,
                turn_s=access.lease.turn.limit_s,
            )
        if self._path is None or now == self._kept:
            return
        try:
            write(self._path, now)
        except OSError as error:
            self._diagnostics.warn(
                f"The teacher's decision is in force, but a restart of this robot's program ends it: {error}."
            )
        self._kept = now
