"""Snapshots of the robot: positions, status, info and clock, built on any thread."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Sequence
from importlib import metadata

from msgspec.structs import asdict, replace

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.state import NO_TELEMETRY, TelemetrySample
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated import messages as msg
from beatrix_zenoh.contract._generated.messages import Head, Info, Positions, Status, Steps
from beatrix_zenoh.contract._generated.robot import GeometryData
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.robot_file import fingerprint
from beatrix_zenoh.node.interfaces import Component, HardwareInterface, StatusFields
from beatrix_zenoh.node.planner import Planner, vector

NO_SAMPLE = TelemetrySample(NO_TELEMETRY, 0)
_SEQS = 2**32


class Snapshot:
    """Builds the messages of one robot; `components` contribute the fields of its status."""

    components: Sequence[Component] = ()

    def __init__(
        self, name: str, hardware: HardwareInterface, board: Board, planner: Planner, endpoint: str
    ) -> None:
        self.name, self.side, self._endpoint = name, hardware.side, endpoint
        self._hardware, self._board, self._planner = hardware, board, planner
        self.sampling_s = hardware.sampling_s
        """Time (s) between two samples of the positions."""
        self._head = Head(0.0, 0.0, 0.0)
        self._head_at: Arms = (0.0, 0.0, 0.0)
        """Arm angles (rad) of this orientation."""
        self._lock = threading.Lock()
        self._seq = 0
        self._published_ns = -1, 0
        """Monotonic and wall time in the last publication."""

    def positions(self, *, count: bool = False) -> Positions:
        """Return the positions, with the sequence number of the last publication; `count`: for a new publication.

        All values belong to the time `t_mono_ns`. Without new telemetry, as after a loss of the board, hardware keeps its
        last time; `repeated` is then true in a publication.
        """
        sample = self._board.sample or NO_SAMPLE
        telemetry = sample.telemetry
        if not self._board.connected:
            telemetry = replace(telemetry, velocity=(0, 0, 0))
        pose = self._hardware.pose(telemetry, sample.t_mono_ns)
        t_mono_ns, t_wall_ns = pose.t_mono_ns, pose.t_mono_ns + time.time_ns() - time.monotonic_ns()
        with self._lock:
            self._seq = (self._seq + count) % _SEQS
            repeated = count and t_mono_ns == self._published_ns[0]
            if repeated:
                t_wall_ns = self._published_ns[1]
            elif count:
                self._published_ns = t_mono_ns, t_wall_ns
            if pose.position != self._head_at:
                self._head_at = pose.position
                # Publish the last orientation if none is possible; the status reports a fault.
                with contextlib.suppress(BeatrixError):
                    self._head = Head(*self._planner.neck.forward(pose.position))
            return Positions(
                seq=self._seq,
                t_mono_ns=t_mono_ns,
                t_wall_ns=t_wall_ns,
                position=vector(pose.position),
                velocity=vector(pose.velocity),
                commanded=vector(self._planner.gear.to_rad(pose.steps)),
                steps=Steps(*pose.steps),
                head=self._head,
                head_measured=None if pose.head is None else Head(*pose.head),
                repeated=repeated,
            )

    def status(self) -> Status:
        """Return the status, from the contributions of all components."""
        fields = StatusFields()
        for component in self.components:
            component.contribute(fields)
        values: dict[str, object] = {
            "t_mono_ns": time.monotonic_ns(),
            "t_wall_ns": time.time_ns(),
            "robot": self.name,
            "side": self.side,
            "plant": self._hardware.plant(),
            "warnings": fields.warnings,
            **fields.lists,
            **fields.values,
        }
        return Status(**values)  # type: ignore[arg-type]  # the constructor checks the names

    def clock(self) -> msg.Clock:
        """Return the clocks of this computer (ns)."""
        return msg.Clock(t_mono_ns=time.monotonic_ns(), t_wall_ns=time.time_ns())

    def info(self) -> Info:
        """Return all data that a program without this library needs to drive this robot."""
        limits, side = self._planner.limits, self.side
        open_names = {name: f"<{name}>" for name in ("who", "arm", "eye", "session", "lesson", "gesture")}
        names = {"robot": self.name, "side": side, **open_names}
        return Info(
            robot=self.name,
            side=side,
            version=metadata.version("beatrix-zenoh"),
            contract=msg.CONTRACT,
            firmware=self._board.status().firmware,
            steps_per_turn=self._planner.gear.steps_per_turn,
            arms=list(ARMS),
            limits=msg.LimitInfo(
                tilt_max=limits.tilt_max,
                gap_min=limits.gap_min,
                yaw_max=limits.yaw_max,
                speed_default=limits.default_speed,
                speed_max=limits.speed_max,
                acceleration=limits.acceleration,
            ),
            geometry=geometry_info(self._planner.robot.geometry),
            fingerprint=fingerprint(self._planner.robot),
            commands=[f"{code.value} {code.name}: {code.text}" for code in msg.Command],
            reasons=[f"{reason}: {reason.text}" for reason in msg.Reason],
            keys=[
                msg.KeyInfo(
                    key=row.key.format_map(names),
                    kind=row.kind,
                    payload=row.payload,
                    reply=row.reply,
                    doc_=keys.KEY_TEXT[name],
                )
                for name, row in keys.KEYS.items()
                if side in row.sides
            ],
            examples=examples(self.name, side, self._endpoint),
        )


def examples(name: str, side: str, endpoint: str) -> list[str]:
    """Return command lines for Zenoh's own example programs that drive, stop and observe this robot."""
    client = f"-m client -e {endpoint}"
    base = keys.motion(name, side, "me").rpartition("/")[0]
    return [
        f"z_get.py {client} -s '{base}/command?command=enable'",
        f"z_get.py {client} -s '{base}/command?command=calibrate'",
        f"z_get.py {client} -s '{base}/pose?yaw=0.35;pitch=-0.17'",
        f"z_get.py {client} -s '{base}/motion?x=0.1;y=0;z=-0.1;speed=0.5'",
        f"z_get.py {client} -s '{keys.stop(name, side, 'me')}'",
        f"z_get.py {client} -s '{keys.events_json(name, side)}'",
        f"z_sub.py {client} -k '{keys.positions_json(name, side)}'",
    ]


def geometry_info(shape: GeometryData) -> msg.GeometryInfo:
    """Return the geometry with angles in rad."""
    angles = asdict(shape)
    hand = angles.pop("hand")
    return msg.GeometryInfo(**{name: math.radians(angle) for name, angle in angles.items()}, hand=hand)
