"""A simulated robot: the firmware on a virtual board, whose steps drive the plant, in real time."""

from __future__ import annotations

import threading
import time
from collections import deque

from beatrix_zenoh.board.state import Port
from beatrix_zenoh.board.virtual import BUSY_S, Firmware, TimedPort
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Fault, PlantStatus, PreviewReply
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.node import ArmState, Component, Node
from sim_node.eyes import Drawing, Eyes
from sim_node.following.handler import FollowHandler
from sim_node.hearing import Hearing, hearing, simulated_microphones
from sim_node.model import TIMESTEP_MS
from sim_node.painter import SceneState
from sim_node.plant import Plant
from sim_node.preview import PreviewHandler, simulate_motion
from sim_node.sound_queries import SoundSource, sound_queries
from sim_node.target import PersonTarget, TargetPath, target_queries
from sim_node.viewer import SceneViewer

PERIOD_S = 1 / keys.positions.rate_hz
"""Period (s) of the turns, which make the steps that are due: that of the publications, which follow in the same pass."""
BUSY_PERIOD_S = 0.010
"""Period (s) just after a frame for the board has arrived: that of the telemetry, which shows its effect."""
RESTING_S = 2 * PERIOD_S
"""Period (s) while the arms rest. Publications make the due steps themselves."""
LATE_S = 0.010
SLICE_S = 0.1
"""Longest simulated time of one call of `due`, so that the board receives its heartbeat between two calls."""
STALL_S = 0.3
"""After a longer delay simulated time continues from now: the robot does not speed up, and misses no heartbeat."""
WINDOW_S = 5.0


class StepClock:
    """Computes how many steps are due; all times in seconds of one monotonic clock."""

    def __init__(self, step_s: float, now_s: float) -> None:
        self._step_s = step_s
        self._due_s = now_s
        self._simulated_s = 0.0
        self._period_s, self._turned_s = PERIOD_S, now_s
        self._marks: deque[tuple[float, float]] = deque([(now_s, 0.0)])
        self.late = 0
        """Steps made more than LATE_S late."""

    def due(self, now_s: float, *, host_is_late: bool = False) -> int:
        """Return the number of steps to make now; 0 after a stall or while the board waits for a late host."""
        behind_s = now_s - self._due_s
        if behind_s > STALL_S or host_is_late:
            self._due_s = now_s
            return 0
        steps = max(0, int(min(behind_s, SLICE_S) / self._step_s + 1e-6))
        if behind_s > LATE_S + self._period_s:
            self.late += min(steps, int((behind_s - LATE_S) / self._step_s))
        self._turned_s = now_s
        self._due_s += steps * self._step_s
        self._simulated_s += steps * self._step_s
        if now_s - self._marks[-1][0] > WINDOW_S / 10:
            self._marks.append((now_s, self._simulated_s))
            while now_s - self._marks[0][0] > WINDOW_S:
                self._marks.popleft()
        return steps

    @property
    def reached_s(self) -> float:
        """The time up to which steps have been made."""
        return self._due_s

    def wait_s(self, now_s: float, period_s: float = PERIOD_S) -> float:
        """Return the seconds until the steps of a period (s) are due; negative if they are late."""
        self._period_s = period_s
        return self._due_s + period_s - now_s

    def real_time_factor(self, now_s: float) -> float:
        """Return the simulated seconds per second over the last WINDOW_S."""
        then_s, simulated_s = self._marks[0]
        # The period ends with the last turn of the thread, because the next turn makes the steps since then. If the
        # next turn is overdue, the period ends now, because the time since the last turn is lost.
        overdue = now_s - self._turned_s > STALL_S
        elapsed_s = (now_s if overdue else self._turned_s) - then_s
        return 1.0 if elapsed_s < PERIOD_S else (self._simulated_s - simulated_s) / elapsed_s


TURN_S = 2 * RESTING_S - 0.0005
"""Longest time (s) between two turns. Each publication makes the steps that are due, so at rest it may always come just
before the turn. A multiple of RESTING_S, less a little, so that the thread does not wake once more for it."""
ASSEMBLY_CHECK_TURNS = 2
"""Turns between two checks of the assembly while arms move: every 40 ms."""
FAULT_SHOWN_S = 5.0
EYES_HZ = 15.0
EYES_HZ_MAX = 30.0


class Simulation:
    """A simulated robot; the thread that reads from the board makes the steps of the plant."""

    side = "sim"
    sampling_s = TIMESTEP_MS / 1000

    def __init__(
        self,
        name: str,
        robot: RobotData = ROBOT,
        *,
        eyes_hz: float = EYES_HZ,
        target: TargetPath = TargetPath.STILL,
        viewer: SceneViewer | None = None,
        follow: bool = False,
        drawing: Drawing | None = None,
    ) -> None:
        """Create the robot and start its physics.

        Args:
            name: name of the robot.
            robot: values of the robot.
            eyes_hz: pictures a second of each eye while a client subscribes; 0: no eyes.
            target: movement of the person in front of the eyes.
            viewer: a window that shows the robot; closed with the simulation.
            follow: follow the hardware of this name from the start on, as soon as the motors are on and home is known.
            drawing: draws the pictures of several simulations; None: only those of this one.
        """
        self._robot, self._eyes_hz, self._viewer, self._follow = robot, eyes_hz, viewer, follow
        self._target = PersonTarget(target, time.monotonic())
        self._sound = SoundSource(lambda: self._target.place(time.monotonic()), time.monotonic)
        self._plant = Plant(robot)
        self._firmware = Firmware(boot=1, name=name)
        self._board = TimedPort(self._firmware, lambda _: self)
        self._clock = StepClock(TIMESTEP_MS / 1000, time.monotonic())
        self._left_s = float("-inf")
        self._pulses, self._steps, self._resting = self._firmware.pulses(), self._firmware.steps(), True
        self._turns, self._busy_until_s, self._turn_until_s = 0, 0.0, 0.0
        self._lock = threading.Lock()
        self._drawing = drawing or Drawing(robot)

    def open_port(self) -> Port:
        """Return the port of the virtual board, which is always present; its time passes from now on."""
        return self.timed_port()

    def timed_port(self) -> TimedPort:
        """Return the port of the virtual board; its time passes from now on."""
        with self._lock:
            self._clock = StepClock(TIMESTEP_MS / 1000, time.monotonic())
        return self._board

    def wait_s(self) -> float:
        """Return the time (s) until the next turn is due; negative if it is late."""
        now_s = time.monotonic()
        busy, resting_s = now_s < self._busy_until_s, RESTING_S if self._resting else PERIOD_S
        wait_s = self._clock.wait_s(now_s, BUSY_PERIOD_S if busy else resting_s)
        return min(wait_s, self._turn_until_s - now_s)

    def turn(self, *, written: bool) -> None:
        """Make the steps that are due; `written`: the board has received bytes, which may move the arms soon."""
        now_s = time.monotonic()
        if written:
            self._busy_until_s = now_s + BUSY_S
        self._turns, self._turn_until_s = self._turns + 1, now_s + TURN_S
        with self._lock:
            self._catch_up()
            check = self._turns % ASSEMBLY_CHECK_TURNS == 0 or self._resting
            if check and not self._plant.asleep and self._plant.home_assembly_left():
                self._plant.reassemble()
                self._left_s = time.monotonic()

    def _catch_up(self) -> None:
        """Make the steps that are due."""
        self._advance(self._clock.due(time.monotonic(), host_is_late=self._board.host_is_late))

    def _advance(self, steps: int) -> None:
        """Advance the board by `steps` physics steps, of SLICE_S at most, then the plant by what its motors received."""
        if steps == 0:
            return
        ms = steps * TIMESTEP_MS
        with self._board.lock:
            self._board.advance(ms)
            motors, self._steps = self._firmware.motors(ms, TIMESTEP_MS), self._firmware.steps()
        for pulses, drivers_on, count in motors:
            self._plant.step(pulses, drivers_on=drivers_on, count=count)
        self._resting, self._pulses = pulses == self._pulses, pulses

    def pose(self, telemetry: Telemetry, t_mono_ns: int) -> ArmState:  # noqa: ARG002
        """Return the measured arms and head, after making the steps that are due: the thread may be 20 ms behind."""
        with self._lock:
            self._catch_up()
            return ArmState(
                t_mono_ns=round(self._clock.reached_s * 1e9),  # the time at which the last step was due
                position=self._plant.arms(),
                velocity=self._plant.velocities(),
                steps=self._steps,
                head=self._plant.head(),
            )

    def straighten(self) -> None:
        """Set the head upright, as a person does before calibrating."""
        with self._lock:
            self._plant.straighten()

    def components(self, node: Node) -> list[Component]:
        """Return the components that only a simulation has: previews, following, the person, eyes, ears, and the viewer."""
        parts: list[Component] = [
            PreviewHandler(node.name, node.controller, self.preview),
            FollowHandler(node.requests, node.controller, node.snapshot, at_start=self._follow),
            target_queries(node.name, self._target, time.monotonic),
            sound_queries(node.name, self._sound),
            simulated_microphones(node, self._robot, self.hearing, self._sound.playing),
        ]
        if self._eyes_hz > 0:
            parts.append(Eyes(node, self._drawing, self._eyes_hz, self.scene_state, lambda: self._clock.late))
        if self._viewer is not None:
            self._viewer.scene_state = self.scene_state
            parts.append(self._viewer)
        return parts

    def scene_state(self) -> SceneState:
        """Return the scene at the last step of the physics."""
        with self._lock:
            reached_s, posture = self._clock.reached_s, self._plant.posture()
        return SceneState(round(reached_s * 1e9), posture, self._target.place(reached_s))

    def hearing(self) -> Hearing:
        """Return ears, arms and the source of sound at the last step of the physics."""
        with self._lock:
            reached_s, head, arms = self._clock.reached_s, self._plant.rotation(), self._plant.arms()
        return hearing(head, arms, self._sound.place(self._target.place(reached_s)), self._robot)

    def preview(self, move: Move | MoveStraight) -> PreviewReply:
        """Carry out the motion on a copy of firmware and plant, and return the reply with its samples."""
        with self._lock, self._board.lock:
            memory, plant = self._firmware.snapshot(), self._plant.copy()
        copy = Firmware(boot=1, name="preview")
        copy.restore(memory)
        return simulate_motion(plant, copy, move)

    def plant(self) -> PlantStatus | None:
        """Return the real-time factor, and the numbers of late steps, slipped motor steps and neck reassemblies."""
        return PlantStatus(
            real_time_factor=self._clock.real_time_factor(time.monotonic()),
            late_steps=self._clock.late,
            slipped_steps=sum(map(abs, self._plant.drive.slipped)),
            re_placed=self._plant.re_placed,
        )

    def fault(self) -> Fault:
        """Return ASSEMBLY_LEFT for FAULT_SHOWN_S after the neck was reassembled, otherwise NONE."""
        recent = time.monotonic() - self._left_s < FAULT_SHOWN_S
        return Fault.ASSEMBLY_LEFT if recent else Fault.NONE

    def close(self) -> None:
        """Stop the simulation."""
        self._board.close()
