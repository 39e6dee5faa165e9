"""A simulation that follows, apart from the hardware: wrong directions, silence, other robot files, freeze."""

from __future__ import annotations

import math
import threading
import time
from pathlib import Path

from msgspec.structs import replace
from old_programs import Program
from robots import Stage, until, wait_status
from statuses import READY

from beatrix_zenoh import Robot
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    FollowState,
    Head,
    LeaseAction,
    LeaseQuery,
    LeaseReply,
    Positions,
    Steps,
    Vector3,
)
from sim_node.body import Simulation


def govern(stage: Stage, name: str, action: LeaseAction) -> None:
    """Send a lease query of the teacher to a simulation."""
    key = keys.lease(name, "sim", "teacher")
    client = stage.client("teacher")
    assert ask(client, (name, "sim"), key, LeaseQuery(action=action), LeaseReply, 10.0).result


def follower(stage: Stage, name: str) -> Robot:
    """Start a simulation that follows, in this process; return it."""
    stage.node(name, Simulation(name, eyes_hz=0.0, follow=True)).make_ready()
    return stage.robot(name, "sim")


class FakeHardware:
    """Publishes positions of a hardware until closed: its set points sway, and its short arm `turns` times as far.

    With `place` (deg) the arms stand there instead; `velocity` (deg/s) is published in any case.
    """

    def __init__(
        self,
        stage: Stage,
        name: str,
        *,
        turns: float = 1.0,
        place: float | None = None,
        velocity: float = 0.0,
    ) -> None:
        self.place, self.velocity = place, velocity
        self._client = stage.client("fake")
        self._name, self._turns = name, turns
        self._began_s = time.monotonic()
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        seq = 0
        while not self._closed.wait(0.02):
            seq += 1
            bus = self._client.bus
            if seq % 50 == 1:
                bus.put(
                    keys.status(self._name, "hw"),
                    codec.encode(replace(READY, robot=self._name, t_mono_ns=time.monotonic_ns())),
                    codec.MSGPACK,
                )
            bus.put(keys.positions(self._name, "hw"), codec.encode(self._positions(seq)), codec.MSGPACK)

    def _positions(self, seq: int) -> Positions:
        now_s = time.monotonic()
        sway = 10 * math.sin(now_s - self._began_s)
        angle = math.radians(sway if self.place is None else self.place)
        velocity = math.radians(self.velocity)
        turned = angle * self._turns
        return Positions(
            seq=seq,
            t_mono_ns=round(now_s * 1e9),
            t_wall_ns=time.time_ns(),
            position=Vector3(turned, angle, angle),
            velocity=Vector3(velocity, 0.0, 0.0),
            commanded=Vector3(angle, angle, angle),
            steps=Steps(0, 0, 0),
            head=Head(angle, 0.0, 0.0),
        )

    def close(self) -> None:
        self._closed.set()
        self._thread.join()


def test_an_arm_that_turns_the_other_way_is_reported_and_a_silent_hardware_is_waited_for() -> None:
    with Stage() as stage:
        simulation = follower(stage, "cid")
        fake = FakeHardware(stage, "cid", turns=-1.0)
        try:
            wait_status(simulation, lambda status: status.following is FollowState.PARTED, "parted")
            wait_status(
                simulation,
                lambda status: (
                    "the short arm of the hardware turns the other way" in " ".join(status.warnings)
                ),
                "the sentence",
            )
            parted = [event for event in simulation.past_events() if "have parted" in event.message]
            assert parted
        finally:
            fake.close()
        wait_status(simulation, lambda status: status.following is FollowState.WAITING, "waiting")
        assert "publishes no positions" in simulation.status().warnings[0]


def test_a_simulation_that_must_wait_brakes_on_its_way() -> None:
    with Stage() as stage:
        simulation = follower(stage, "eli")
        fake = FakeHardware(stage, "eli", place=80.0)
        try:
            until(lambda: simulation.positions().arms.short > 5, "on its way")
        finally:
            fake.close()
        wait_status(simulation, lambda status: status.following is FollowState.WAITING, "waiting")
        until(lambda: not simulation.status().moving, "it has braked")
        assert simulation.positions().arms.short < 60


def test_while_two_programs_publish_it_holds_its_place() -> None:
    with Stage() as stage:
        simulation = follower(stage, "gil")
        fake = FakeHardware(stage, "gil", place=0.0)
        try:
            wait_status(simulation, lambda status: status.following is FollowState.FOLLOWING, "following")
            other = FakeHardware(stage, "gil", place=60.0)
            try:
                words = "Two programs publish the positions of the hardware"
                wait_status(simulation, lambda status: words in " ".join(status.warnings), "the warning")
                until(lambda: not simulation.status().moving, "it has braked")
                assert simulation.positions().arms.short < 10
            finally:
                other.close()
            wait_status(simulation, lambda status: status.following is FollowState.FOLLOWING, "following")
            until(lambda: abs(simulation.positions().arms.short) < 0.5, "it is back")
        finally:
            fake.close()


def test_freeze_ends_following_and_a_program_of_2023_at_the_simulation_is_refused(tmp_path: Path) -> None:
    terminal = tmp_path / "COM5"
    with Stage() as stage:
        stage.simulation("eva", "--follow", "--eyes-hz", "0", "--legacy", str(terminal))
        simulation = stage.robot("eva", "sim")
        program = Program(terminal)
        try:
            assert program.say("@CALNOW")[-1] == "ACK\n"  # the zero of its port only
            assert program.say("@MOVRX 20 200")[-1] == "NACK\n"
        finally:
            program.port.close()
        assert simulation.status().following is FollowState.WAITING
        govern(stage, "eva", LeaseAction.FREEZE)
        wait_status(simulation, lambda status: status.following is FollowState.OFF, "off")
        until(
            lambda: any("the teacher has frozen it" in event.message for event in simulation.past_events()),
            "the event",
        )
