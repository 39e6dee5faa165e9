"""A simulation that follows: its control law, on two virtual boards in virtual time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import HEARTBEAT_PERIOD, FrameType, Move
from beatrix_zenoh.motion.gear import Arms, Gear
from sim_node.following.follower import Course, Limits, SetPoint, course_to, distance

GEAR = Gear()
LIMITS = Limits(math.radians(30), math.radians(90), math.radians(180))
REST: Arms = (0.0, 0.0, 0.0)
MICROSTEP = math.tau / GEAR.steps_per_turn


def board() -> Firmware:
    """Return a board with motors on and home known."""
    firmware = Firmware()
    firmware.receive(encode(FrameType.ENABLE, 1, b"\1"))
    firmware.receive(encode(FrameType.CALIBRATE, 2, b""))
    return firmware


def deg(*angles: float) -> Arms:
    x, y, z = map(math.radians, angles)
    return x, y, z


@dataclass
class Pair:
    """Two boards in virtual time: the second follows the first, whose set points arrive every 20 ms, `delay_ms` late."""

    delay_ms: int = 8
    hardware: Firmware = field(default_factory=board)
    simulation: Firmware = field(default_factory=board)
    ms: int = 0
    places: list[tuple[Arms, Arms]] = field(default_factory=list)
    """set points (rad) of both boards after each millisecond"""
    _arriving: list[tuple[int, SetPoint]] = field(default_factory=list)
    _before: Arms = REST
    _number: int = 0

    def move(self, target: Sequence[float], speed: float) -> None:
        """Move the hardware to these angles (deg) at a speed (deg/s)."""
        self._send(self.hardware, Course(deg(*target), deg(speed, speed, speed)))

    def run(self, ms: int) -> None:
        for _ in range(ms):
            self.ms += 1
            for one in (self.hardware, self.simulation):
                if self.ms % HEARTBEAT_PERIOD == 0:
                    one.receive(encode(FrameType.PING, 4, b""))
                one.tick(1)
                one.transmit()
            self.places.append((self._place(self.hardware), self._place(self.simulation)))
            if self.ms % 20 == 0:
                self._arriving.append((self.ms + self.delay_ms, self._point(0)))
            while self._arriving and self._arriving[0][0] <= self.ms:
                self._hear(self._arriving.pop(0)[1])

    def _hear(self, hardware: SetPoint) -> None:
        own = self._point(1)
        course = course_to(
            hardware, self._before, own, acceleration=LIMITS.acceleration, speed_max=LIMITS.speed_max
        )
        self._before = hardware.velocity
        self._send(self.simulation, course)

    def _point(self, which: int) -> SetPoint:
        here, before = self.places[-1][which], self.places[-2][which]
        x, y, z = ((now - then) * 1000 for now, then in zip(here, before, strict=True))
        return SetPoint(here, (x, y, z))

    def _place(self, one: Firmware) -> Arms:
        return GEAR.to_rad(one.set_points())

    def _send(self, one: Firmware, course: Course) -> None:
        self._number += 1
        move = Move(self._number, GEAR.to_steps(course.target), GEAR.speed_to_quarters(course.speed))
        one.receive(encode(move.kind, 3, move.pack()))


def test_a_stream_of_targets_is_followed_within_two_degrees() -> None:
    pair = Pair()
    pair.run(40)
    for step in range(250):
        angle = 25 * math.sin(step / 20)
        pair.move((angle, angle, angle), 60)
        pair.run(20)
    assert max(distance(*both) for both in pair.places) < math.radians(2)


angles = st.floats(-60.0, 60.0)


@settings(max_examples=6, deadline=None)
@given(
    targets=st.lists(st.tuples(angles, st.floats(5.0, 90.0), st.integers(50, 900)), min_size=1, max_size=5)
)
def test_whatever_the_hardware_does_both_rest_in_the_same_place(
    targets: list[tuple[float, float, int]],
) -> None:
    pair = Pair()
    pair.run(40)
    for angle, speed, ms in targets:
        pair.move((angle, angle, angle), speed)
        pair.run(ms)
    pair.move((0, 0, 0), 90)
    pair.run(3000)
    assert pair.simulation.steps() == pair.hardware.steps()
