"""Previews of motions on copies of firmware and plant."""

from __future__ import annotations

import math

import pytest
from firmware_host import Rig

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.messages import PreviewReply, Reason
from beatrix_zenoh.contract._generated.serial import FrameType, Move, MoveStraight
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.node.planner import tuple3
from sim_node.plant import Plant
from sim_node.preview import simulate_motion

GEAR = Gear()
NECK = Neck()
NODDED = NECK.inverse(0.3, 0.35, 0.0)


def move_to(arms: Arms, speed: float = 30.0) -> MoveStraight:
    """Return a straight motion to these arms (rad) at a speed (deg/s)."""
    return MoveStraight(7, GEAR.to_steps(arms), GEAR.speed_to_quarters([math.radians(speed)] * 3)[0])


def ready() -> tuple[Plant, Firmware]:
    """Return a plant and its firmware, with motors on and calibrated."""
    plant, firmware = Plant(), Firmware()
    Rig(firmware).ready()
    pass_time(plant, firmware, 40)
    return plant, firmware


def pass_time(plant: Plant, firmware: Firmware, ms: int) -> None:
    for _ in range(ms // 2):
        firmware.tick(2)
        plant.step(firmware.pulses(), drivers_on=firmware.drivers_on())


def preview(move: Move | MoveStraight) -> PreviewReply:
    return simulate_motion(*ready(), move)


def test_the_motion_is_the_same_as_its_preview() -> None:
    plant, firmware = ready()
    copy = Firmware()
    copy.restore(firmware.snapshot())
    seen = simulate_motion(plant.copy(), copy, move_to(NODDED))
    firmware.receive(encode(FrameType.MOVE_STRAIGHT, 3, move_to(NODDED).pack()))
    for arms, head in zip(seen.arms, seen.head, strict=True):
        assert plant.arms() == pytest.approx(tuple3(arms), abs=1e-9)
        assert plant.head() == pytest.approx((head.yaw, head.pitch, head.roll), abs=1e-9)
        firmware.receive(encode(FrameType.PING, 4, b""))
        pass_time(plant, firmware, 20)


def test_a_motion_that_the_firmware_refuses_has_no_preview() -> None:
    with pytest.raises(Refused) as refusal:
        simulate_motion(Plant(), Firmware(), move_to(NODDED))
    assert refusal.value.reason is Reason.NOT_ENABLED


def test_a_motion_that_the_firmware_guard_would_stop_is_refused() -> None:
    """The short arm is so much faster that it catches up with the middle one."""
    half_turn = math.radians(170)
    speeds = GEAR.speed_to_quarters([math.radians(speed) for speed in (80.0, 10.0, 10.0)])
    with pytest.raises(Refused, match="too close") as refusal:
        preview(Move(7, GEAR.to_steps([half_turn] * 3), speeds))
    assert refusal.value.reason is Reason.ARM_GAP


def test_a_motion_that_takes_too_long_is_refused_with_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim_node.preview.LONGEST_MS", 1000)
    with pytest.raises(Refused, match="higher speed") as refusal:
        preview(move_to((3.0, 3.0, 3.0), speed=1.0))
    assert refusal.value.reason is Reason.TIMED_OUT


def test_largest_tilt_and_smallest_gap_are_those_of_the_whole_motion() -> None:
    seen = preview(move_to(NODDED))
    tilts = [math.acos(math.cos(at.pitch) * math.cos(at.roll)) for at in seen.head]
    assert seen.tilt_max >= max(tilts) - 1e-9
    assert seen.tilt_max == pytest.approx(0.35, abs=math.radians(0.5))
    assert seen.gap_min == pytest.approx(min(NECK.gaps(NODDED)), abs=math.radians(1.0))
