"""The two robots of a simulation that follows: messages of the hardware, and its own arms."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.bus import Received, Reply, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Info, Positions, Status
from beatrix_zenoh.contract._generated.serial import Move, MoveStraight
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.contract.publishers import Publishers
from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.planner import tuple3
from beatrix_zenoh.node.snapshot import Snapshot
from sim_node.following.follower import HardwareSample, Limits, Places, SetPoint, Step, advanced

ANSWER_S: Final = 5.0
"""Longest wait (s) for the robot file of the hardware."""


class HardwareMessages:
    """Receives positions and status of the hardware of one name; the callbacks run on Zenoh's thread."""

    def __init__(
        self, name: str, on_sample: Callable[[HardwareSample], None], on_status: Callable[[Status], None]
    ) -> None:
        self._name, self._on_sample, self._on_status = name, on_sample, on_status
        self._ends: list[Callable[[], None]] = []
        self._publishers = Publishers()

    def open(self, sessions: Sessions) -> None:
        """Subscribe."""
        self._ends += [
            sessions.subscribe(keys.positions(self._name, "hw"), self._positions),
            sessions.subscribe(keys.status(self._name, "hw"), self._status),
        ]

    def ask_file(self, sessions: Sessions, handle: Callable[[str], None]) -> None:
        """Pass the fingerprint of the hardware's robot file to `handle`, on Zenoh's thread; empty if it has none."""

        def read(reply: Reply) -> None:
            try:
                handle(codec.decode(reply.payload, Info).fingerprint or "")
            except BeatrixError:  # an error reply, or the reply of a foreign program
                return

        bus = sessions.session(keys.KEYS["info"].session)
        query = bus.query(keys.info(self._name, "hw"), None, codec.MSGPACK, timeout_s=ANSWER_S)
        self._ends.append(query.close)
        query.hand_over(read)

    def close(self) -> None:
        """End the subscriptions and the queries."""
        for end in self._ends:
            end()
        self._ends = []

    def _positions(self, received: Received) -> None:
        try:
            positions = codec.decode(received.payload, Positions)
        except BeatrixError:  # it does not come from a node of this version
            return
        contested = self._publishers.several(positions.seq)
        self._on_sample(HardwareSample.of(positions, time.monotonic(), contested=contested))

    def _status(self, received: Received) -> None:
        try:
            self._on_status(codec.decode(received.payload, Status))
        except BeatrixError:
            return


def follows(access: Access) -> bool:
    """Return whether the simulation may still follow; call this just before each motion. Freeze ends it, as STOP does."""
    with access.lock:
        access.following &= not access.teacher.frozen
        access.begun += access.following
        return access.following


class OwnArms:
    """The arms of the simulation; all methods run on the controller's thread."""

    def __init__(self, controller: MotionController, snapshot: Snapshot) -> None:
        self._controller, self._snapshot = controller, snapshot
        self._board, self._planner = controller.board, controller.planner
        self._last: Move | MoveStraight | None = None

    def set_point(self, now_s: float) -> SetPoint | None:
        """Return the set points at `now_s` (monotonic clock, s); None before the first telemetry."""
        sample, gear = self._board.sample, self._planner.gear
        if sample is None:
            return None
        telemetry = sample.telemetry
        point = SetPoint(gear.to_rad(telemetry.position), gear.to_rad(telemetry.velocity))
        return advanced(point, now_s - sample.t_mono_ns / 1e9)

    def limits(self) -> Limits:
        """Return the limits of the arms; the teacher may change them at any time."""
        limits = self._planner.limits
        return Limits(limits.default_speed, limits.speed_max, limits.acceleration)

    def measured(self) -> tuple[float, Places]:
        """Return a time (monotonic clock, s), and the measured places of arms and head then."""
        now = self._snapshot.positions()
        head = now.head_measured or now.head
        places = Places(tuple3(now.position), tuple3(now.velocity), (head.yaw, head.pitch, head.roll))
        return now.t_mono_ns / 1e9, places

    def move(self, step: Step) -> None:
        """Begin a motion, unless it is the last one or the arms rest at its target.

        Raises BeatrixError if its path exceeds a limit, or if the firmware refuses it.
        """
        try:
            self._send(self._frame(step))
        except Refused:
            # A target ahead of the hardware may exceed a guard of the firmware, although the hardware does not.
            if step.careful is None:
                raise
            self._send(self._frame(Step(step.careful, straight=False)))

    def _send(self, frame: Move | MoveStraight) -> None:
        if frame == self._last:
            return
        telemetry = self._board.ready_telemetry()
        if telemetry.position == frame.target and not any(telemetry.velocity):
            return
        controller = self._controller
        if follows(self._controller.access):
            controller.follows, controller.last_goal = True, None
            controller.send(lambda number: replace(frame, motion=number))
            self._board.wake()
            self._last = frame

    def _frame(self, step: Step) -> Move | MoveStraight:
        """Return the frame of a motion, without its number; raises Refused if its path exceeds a limit."""
        planner, (target, speed) = self._planner, step.course
        steps, quarters = planner.gear.to_steps(target), planner.gear.speed_to_quarters(speed)
        if not step.straight:
            return Move(0, steps, quarters)
        telemetry = self._board.ready_telemetry()
        start, velocity = planner.gear.to_rad(telemetry.position), planner.gear.to_rad(telemetry.velocity)
        sent = planner.gear.quarters_to_speed(quarters)
        planner.limits.check_motion(start, velocity, target, sent, straight=True)
        return MoveStraight(0, steps, quarters[0])
