"""The simulated head as an environment of Gymnasium, in virtual time, about twenty times as fast as the robot.

`gymnasium.make("beatrix_zenoh.gym:BeatrixHead-v0")`. The task: turn the head to a goal, and rest there. A step is 20 ms
of firmware and physics. Needs `beatrix install gym`.
"""

from __future__ import annotations

import importlib
import math
from typing import Final, Protocol

import gymnasium
import numpy as np
import numpy.typing as npt

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.portrait import Pixels, PoseRenderer
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.errors import BeatrixError, bad_value

MODULE: Final = "sim_node.bench"
"""Loaded by name, because this package must not import the simulation."""
STEP_S: Final = 0.02
STEPS: Final = 250
"""Steps until an episode is truncated: 5 s."""
SPEED: Final = math.radians(60.0)
"""Speed (rad/s) of the set point for an action of 1."""
YAW, TILT = math.radians(60.0), math.radians(20.0)
"""Furthest goals (rad) from home."""
NEAR, SLOW = math.radians(1.0), math.radians(2.0)
"""An episode ends when the head is this near to its goal (rad), and no arm is faster (rad/s)."""
REFUSED: Final = -1.0
"""Reward of a step whose set point the robot refuses, in addition."""
LARGEST: Final = np.repeat(np.array([math.pi, math.pi, 10.0], np.float32), 3)
"""Bounds of the observation."""
PICTURE: Final = (480, 480)
DRAWN: Final = "rgb_array"

Array = npt.NDArray[np.float32]


class VirtualRobot(Protocol):
    """A calibrated robot in virtual time, as sim_node/bench.py makes it. Angles in deg."""

    def tick(self, target: tuple[float, float, float]) -> dict[str, list[float]]:
        """Turn to yaw, pitch and roll for 20 ms, and return the state; raises BeatrixError if it is refused."""

    def advance(self) -> None:
        """Let 20 ms pass."""

    def state(self) -> dict[str, list[float]]:
        """Return where arms and head are."""


class HeadEnv(gymnasium.Env[Array, Array]):
    """Turn the head to a goal.

    Action (3): speed of the set point in yaw, pitch and roll, from -1 to 1, which is 60°/s.
    Observation (9): yaw, pitch and roll of the head (rad), those of the goal (rad), velocities of the arms (rad/s).
    Reward: minus the distance to the goal (rad), and -1 for a set point outside the limits, which the robot refuses:
    `info["refused"]` has the sentence.
    """

    metadata = {"render_modes": [DRAWN], "render_fps": round(1 / STEP_S)}  # noqa: RUF012 - as its base class

    def __init__(self, render_mode: str | None = None) -> None:
        """Prepare; raises Refused (BAD_VALUE) without a simulation."""
        try:
            self._make = importlib.import_module(MODULE).VirtualTimeRobot
        except ImportError as error:
            raise bad_value(f"The simulation needs {error.name}. Run `beatrix install gym`.") from error
        self.render_mode = render_mode
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (3,))
        self.observation_space = gymnasium.spaces.Box(-LARGEST, LARGEST)
        if render_mode not in (None, DRAWN):
            raise bad_value(f"render_mode {render_mode!r} is neither None nor {DRAWN!r}.")
        self._renderer = PoseRenderer(Figure(), *PICTURE) if render_mode else None

    def reset(
        self, *, seed: int | None = None, options: dict[str, object] | None = None
    ) -> tuple[Array, dict[str, object]]:
        """Begin at home; `options`: the goal as `{"goal": (yaw, pitch, roll)}` (rad), by default a random one."""
        super().reset(seed=seed)
        around, out = self.np_random.uniform(0.0, math.tau), TILT * math.sqrt(self.np_random.uniform())
        goal = (self.np_random.uniform(-YAW, YAW), out * math.cos(around), out * math.sin(around))
        self._goal = np.array((options or {}).get("goal", goal), np.float64)
        if self._goal.shape != (3,) or not np.all(np.abs(self._goal) <= math.pi):
            raise bad_value("The goal must be yaw, pitch and roll (rad), each from -π to π.")
        self._robot: VirtualRobot = self._make(ROBOT.limits.speed_max)
        self._target = np.zeros(3)
        return self._observe(), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, object]]:
        """Move the set point for 20 ms."""
        info: dict[str, object] = {}
        target = self._target + np.clip(action, -1.0, 1.0) * SPEED * STEP_S
        try:
            yaw, pitch, roll = np.degrees(target).tolist()
            self._robot.tick((yaw, pitch, roll))
            self._target = target
        except BeatrixError as error:
            self._robot.advance()
            info["refused"] = error.message
        seen = self._observe()
        distance = float(np.linalg.norm(seen[:3] - self._goal))
        done = distance < NEAR and float(np.abs(seen[6:]).max()) < SLOW
        return seen, -distance + REFUSED * bool(info), done, False, info

    def render(self) -> Pixels | None:
        """Return a picture of the head, (480, 480, 3), with the render mode `rgb_array`."""
        if self._renderer is None:
            return None
        state = self._robot.state()
        return self._renderer.picture(np.array(state["arms"]), np.array(state["head"]))

    def _observe(self) -> Array:
        state = self._robot.state()
        return np.array([*np.radians(state["head"]), *self._goal, *np.radians(state["speed"])], np.float32)


gymnasium.register(id="BeatrixHead-v0", entry_point="beatrix_zenoh.gym:HeadEnv", max_episode_steps=STEPS)
