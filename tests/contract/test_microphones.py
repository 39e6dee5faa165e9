"""Microphones, on every body that has them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
import pytest
from bodies import Body
from robots import wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Status


def streams(status: Status) -> bool:
    return status.microphones is not None and status.microphones.streaming


@pytest.fixture
def listener(body: Body) -> Iterator[Robot]:
    """A client of a robot with microphones, which are off."""
    robot = body.robot()
    wait_status(robot, lambda status: not streams(status), "no subscriber is left")
    yield robot
    robot.client.close()


def test_blocks_follow_each_other_without_a_gap(listener: Robot) -> None:
    with listener.microphones() as sound:
        blocks = [sound.next() for _ in range(25)]
    assert sound.faults.duplicated == sound.faults.late == 0
    for block in blocks:
        assert block.samples.shape == (960, 2)
        assert block.samples.dtype == np.float32
        assert block.rate == 48_000
    for one, two in itertools.pairwise(blocks):
        lost = two.seq - one.seq - 1 + (two.dropped - one.dropped) // 960
        assert two.t_mono_ns - one.t_mono_ns == 20_000_000 * (1 + lost)


def test_listen_returns_as_much_as_was_asked_for_with_times_of_the_robot(listener: Robot) -> None:
    sound = listener.listen(0.25)
    assert sound.samples.shape == (12_000, 2)
    assert sound.lost < 12_000
    assert np.abs(sound.samples).max() > 0, "something is heard, noise at least"
    with listener.microphones() as blocks:
        arrival = blocks.next_arrival()
    age_s = (arrival.t_mono_ns - arrival.value.t_mono_ns) / 1e9
    assert 0.02 <= age_s < 10.0, "a block arrives after its last frame was heard"
    assert 0 < arrival.t_wall_ns - arrival.value.t_wall_ns < 10e9
