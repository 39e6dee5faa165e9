"""What a robot says of itself: positions, status, info, clock."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from importlib import metadata

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated import messages as msg
from beatrix_zenoh._generated.messages import Fault, Head, Info, Positions, Status, Steps
from beatrix_zenoh._generated.robot import Geometry
from beatrix_zenoh._generated.serial import State, Telemetry
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.body import Body, Pose
from beatrix_zenoh.node.course import Course, vector
from beatrix_zenoh.node.driver import Driver
from beatrix_zenoh.robot_file import fingerprint

NO_TELEMETRY = Telemetry(0, 0, 0, 0, 0, (0, 0, 0), (0, 0, 0), 0)


class Reporter:
    """Builds the messages a robot publishes; may be asked from any thread."""

    def __init__(
        self, name: str, body: Body, board: Board, driver: Driver, course: Course, endpoint: str
    ) -> None:
        self._name, self._endpoint = name, endpoint
        self._body = body
        self._board = board
        self._driver = driver
        self._course = course
        self._head = Head(0.0, 0.0, 0.0)
        self._lock = threading.Lock()
        self._seq = 0

    def positions(self, *, count: bool) -> Positions:
        """Where the robot is; `count` numbers a publication, without it the newest number is repeated."""
        telemetry = self._board.telemetry or NO_TELEMETRY
        if not self._board.connected:
            telemetry = telemetry._replace(velocity=(0, 0, 0))  # where it was seen last; nobody knows of more
        pose: Pose = self._body.pose(telemetry)
        with self._lock:
            self._seq = (self._seq + count) % 2**32
            with contextlib.suppress(BeatrixError):  # out of its home assembly: the fault says so
                self._head = Head(*self._course.neck.forward(pose.position))
            return Positions(
                seq=self._seq,
                t_mono_ns=time.monotonic_ns(),
                t_wall_ns=time.time_ns(),
                position=vector(pose.position),
                velocity=vector(pose.velocity),
                commanded=vector(self._course.gear.to_rad(telemetry.position)),
                steps=Steps(*telemetry.position),
                head=self._head,
            )

    def status(self) -> Status:
        """State of the robot."""
        telemetry = self._board.telemetry or NO_TELEMETRY
        link = self._board.link
        state = telemetry.state if link.connected else 0
        return Status(
            t_mono_ns=time.monotonic_ns(),
            t_wall_ns=time.time_ns(),
            robot=self._name,
            twin=self._body.twin,
            enabled=bool(state & State.ENABLED),
            calibrated=bool(state & State.CALIBRATED),
            moving=bool(state & State.MOVING),
            motion=telemetry.motion,
            fault=self._fault(telemetry),
            warnings=[*filter(None, [link.trouble]), *self._driver.warnings],
            calibrations=self._driver.calibrations,
            holder=self._driver.holder,
            board=msg.BoardStatus(
                connected=link.connected,
                port=link.port,
                name=link.name,
                firmware=link.version,
                contract="" if link.hello is None else f"{link.hello.contract:08x}",
                boot=link.boot,
                rejected_frames=link.rejected + telemetry.rejected,
                retries=link.retries,
            ),
            plant=self._body.plant(),
        )

    def _fault(self, telemetry: Telemetry) -> Fault:
        link = self._board.link
        if link.foreign:
            return Fault.CONTRACT_MISMATCH
        if not link.connected:
            return Fault.BOARD_LOST
        if telemetry.state & State.EMERGENCY:
            return Fault.EMERGENCY
        return self._body.fault()

    def clock(self) -> msg.Clock:
        """Clocks of this machine, ns."""
        return msg.Clock(t_mono_ns=time.monotonic_ns(), t_wall_ns=time.time_ns())

    def info(self) -> Info:
        """What a stranger needs to drive this robot."""
        limits, twin = self._course.limits, self._body.twin
        names = {"robot": self._name, "twin": twin, "who": "<who>", "arm": "<arm>", "session": "<session>"}
        client = f"-m client -e {self._endpoint}"
        base = keys.motion(self._name, twin, "me").rpartition("/")[0]
        return Info(
            robot=self._name,
            twin=twin,
            version=metadata.version("beatrix-zenoh"),
            contract=msg.CONTRACT,
            firmware=self._board.link.version,
            steps_per_turn=self._course.gear.steps_per_turn,
            arms=["short", "middle", "long"],
            limits=msg.LimitInfo(
                tilt_max=limits.tilt_max,
                gap_min=limits.gap_min,
                yaw_max=limits.yaw_max,
                speed_default=limits.default_speed,
                speed_max=limits.speed_max,
                acceleration=limits.acceleration,
            ),
            geometry=geometry_info(self._course.robot.geometry),
            fingerprint=fingerprint(self._course.robot),
            commands=[f"{code.value} {code.name}: {text}" for code, text in msg.COMMAND_TEXT.items()],
            reasons=[f"{reason}: {text}" for reason, text in msg.REASON_TEXT.items()],
            keys=[
                msg.KeyInfo(
                    key=row.key.format_map(names),
                    kind=row.kind,
                    payload=row.payload,
                    reply=row.reply,
                    doc_=row.doc,
                )
                for row in keys.KEYS.values()
                if twin in row.twins
            ],
            examples=[
                f"z_get.py {client} -s '{base}/command?command=enable'",
                f"z_get.py {client} -s '{base}/command?command=calibrate'",
                f"z_get.py {client} -s '{base}/pose?yaw=0.35;pitch=-0.17'",
                f"z_get.py {client} -s '{base}/motion' -p '0.1 0 -0.1 0.5'",
                f"z_get.py {client} -s '{keys.stop(self._name, twin)}'",
                f"z_sub.py {client} -k '{keys.positions_json(self._name, twin)}'",
            ],
        )


def geometry_info(shape: Geometry) -> msg.GeometryInfo:
    """Degrees to radians."""
    return msg.GeometryInfo(
        arm_angle=math.radians(shape.arm_angle),
        rod_twist=math.radians(shape.rod_twist),
        mount_angle=math.radians(shape.mount_angle),
        arm0_azimuth=math.radians(shape.arm0_azimuth),
        arm_spacing=math.radians(shape.arm_spacing),
        hand=shape.hand,
    )
