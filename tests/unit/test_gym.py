"""The environment of Gymnasium keeps Gymnasium's rules, and the program of its page reaches the goal."""

from __future__ import annotations

import math
import re
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from beatrix_zenoh import Refused, gym

PAGE = Path(__file__).resolve().parents[2] / "docs/how-to/gym.md"
MAKE = "beatrix_zenoh.gym:BeatrixHead-v0"


def test_gymnasium_finds_no_fault() -> None:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        check_env(gymnasium.make(MAKE, render_mode="rgb_array").unwrapped)
    assert [str(one.message) for one in found] == []


def test_the_program_of_the_page_reaches_the_goal(capsys: pytest.CaptureFixture[str]) -> None:
    found: dict[str, Any] = {}
    for program in re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL):
        exec(program, found)
    assert capsys.readouterr().out == "there\n"
    assert (found["seen"].shape, found["seen"].dtype) == ((4, 9), np.float32)


def test_a_seed_repeats_an_episode() -> None:
    env, nod = gym.HeadEnv(), np.array([0.5, 1.0, -0.5], np.float32)
    one, other = ([env.reset(seed=3)[0], *(env.step(nod)[0] for _ in range(20))] for _ in range(2))
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("seed", range(5))
def test_every_goal_can_be_reached(seed: int) -> None:
    env = gym.HeadEnv()
    seen, _ = env.reset(seed=seed)
    for _ in range(gym.STEPS):
        seen, reward, done, _, info = env.step((2 * (seen[3:6] - seen[:3])).clip(-1, 1))
        assert info == {}
        assert reward == pytest.approx(-np.linalg.norm(seen[3:6] - seen[:3]), abs=1e-5)
        if done:
            return
    pytest.fail("the head has not reached its goal")


@pytest.mark.parametrize("goal", [(1.0, 2.0), (math.nan, 0.0, 0.0), (9.0, 0.0, 0.0)])
def test_a_goal_that_is_none_is_refused(goal: tuple[float, ...]) -> None:
    with pytest.raises(Refused, match="goal must be yaw, pitch and roll"):
        gym.HeadEnv().reset(options={"goal": goal})


def test_a_refused_set_point_costs_and_time_passes() -> None:
    env = gym.HeadEnv(render_mode="rgb_array")
    env.reset(seed=0, options={"goal": (0.0, 0.0, 0.0)})
    nod = np.array([0.0, 1.0, 0.0], np.float32)
    pictures, steps = [env.render()], [env.step(nod) for _ in range(60)]
    pictures.append(env.render())
    seen, rewards, _, _, infos = zip(*steps, strict=True)
    first = next(number for number, info in enumerate(infos) if info)
    assert "at most 35.0° is allowed" in str(infos[first]["refused"])
    assert all(np.array(rewards[first:]) < gym.REFUSED - np.radians(20.0))
    assert seen[first][1] < seen[-1][1] < np.radians(35.1)
    one, other = (np.asarray(picture) for picture in pictures)
    assert one.shape == (480, 480, 3)
    assert np.any(one != other)
