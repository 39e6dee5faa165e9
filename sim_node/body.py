"""The body of a simulation: the firmware on a virtual board, its steps driving the plant, in real time."""

from __future__ import annotations

import threading
import time

from beatrix_zenoh import threads
from beatrix_zenoh._generated.messages import Fault, PlantStatus
from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.board.board import Port
from beatrix_zenoh.board.virtual import Firmware, VirtualBoard
from beatrix_zenoh.node import Pose, Preview
from sim_node.clock import Pace
from sim_node.model import TIMESTEP_MS
from sim_node.plant import Plant
from sim_node.preview import run_ahead

ALARM_EVERY = 5
"""Turns between two looks at the assembly while arms move: every 30 ms."""
RESTING_STEPS = 4
"""In 8 ms a motion that begins makes less than a microstep."""
FAULT_SHOWN_S = 5.0


class Simulation:
    """A robot in physics only; one thread of its own owns plant and time."""

    twin = "sim"

    def __init__(self, name: str, robot: RobotData = ROBOT) -> None:
        self._plant = Plant(robot)
        self._firmware = Firmware(boot=1, name=name)
        self._board = VirtualBoard(self._firmware)
        self._pace = Pace(TIMESTEP_MS / 1000, time.monotonic())
        self._pose = Pose(self._plant.arms(), self._plant.velocities())
        self._left_s = float("-inf")
        self._pulses, self._resting = self._firmware.pulses(), True
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._thread = threads.start(self._run, "physics")

    def open_port(self) -> Port:
        """The virtual board; always there."""
        return self._board

    def _run(self) -> None:
        turn, spoken = 0, False
        spoken_to = self._board.spoken_to
        while not self._closed.is_set():
            # What was said a moment ago may begin to move the arms with the next step only.
            resting = self._resting and not spoken
            spoken = spoken_to.wait(self._pace.wait_s(time.monotonic(), resting=resting))
            spoken_to.clear()
            turn += 1
            with self._lock:
                self._advance(self._pace.due(time.monotonic(), host_is_late=self._board.host_is_late))
                if (turn % ALARM_EVERY == 0 or self._resting) and self._plant.home_assembly_left():
                    self._plant.re_place()
                    self._left_s = time.monotonic()
                self._pose = Pose(self._plant.arms(), self._plant.velocities())

    def _advance(self, steps: int) -> None:
        """Board and plant in turn; with arms that rest the board some steps at once, which halves what idling costs."""
        while steps > 0:
            together = min(steps, RESTING_STEPS if self._resting else 1)
            with self._board.lock:
                self._board.advance(together * TIMESTEP_MS)
                pulses, drivers_on = self._firmware.outputs()
            for _ in range(together):
                self._plant.step(pulses, drivers_on=drivers_on)
            self._resting, self._pulses = pulses == self._pulses, pulses
            steps -= together

    def pose(self, telemetry: Telemetry) -> Pose:  # noqa: ARG002
        """Arms measured in the plant."""
        return self._pose

    def straighten(self) -> None:
        """Set the head upright, as a person would before calibrating."""
        with self._lock:
            self._plant.straighten()

    def preview(self, move: Move | MoveStraight) -> Preview | None:
        """Run a copy of firmware and plant ahead of time."""
        with self._lock, self._board.lock:
            memory, plant = self._firmware.snapshot(), self._plant.copy()
        copy = Firmware(boot=1, name="preview")
        copy.restore(memory)
        return run_ahead(plant, copy, move)

    def plant(self) -> PlantStatus | None:
        """Pace and mishaps."""
        return PlantStatus(
            real_time_factor=self._pace.real_time_factor(time.monotonic()),
            late_steps=self._pace.late,
            slipped_steps=sum(map(abs, self._plant.slipped())),
            re_placed=self._plant.re_placed,
        )

    def fault(self) -> Fault:
        """ASSEMBLY_LEFT for a while after the neck had to be put back."""
        recent = time.monotonic() - self._left_s < FAULT_SHOWN_S
        return Fault.ASSEMBLY_LEFT if recent else Fault.NONE

    def close(self) -> None:
        """Stop time."""
        self._closed.set()
        self._board.spoken_to.set()
        self._thread.join(timeout=2.0)
        self._board.close()
