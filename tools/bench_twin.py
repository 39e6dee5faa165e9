"""Measure the differences between simulation and virtual hardware, their causes, and the accuracy of a replay.

The program plays the choreography of the demo on both, compares the recordings, and replays one on the hardware. It
takes a minute.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from beatrix_zenoh import Robot, Twin
from beatrix_zenoh.client.choreography import play, shipped
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Positions
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.demo.verbs import start
from beatrix_zenoh.paths.follow import follow
from beatrix_zenoh.paths.path import path_of_recording
from beatrix_zenoh.paths.replay import replay
from beatrix_zenoh.processes import Supervisor
from beatrix_zenoh.recording.alignment import aligned
from beatrix_zenoh.recording.compare import compare
from beatrix_zenoh.recording.motion_shifts import NEAR_S, best_shift
from beatrix_zenoh.recording.series import Floats, Recording, recording
from beatrix_zenoh.recording.verbs.comparison_text import axes_table
from beatrix_zenoh.shutdown import signals_interrupt

SETTLE_S = 0.6
EARLY_DEG = (1.0, 6.0)
"""Range of the angle since rest in which an arm still accelerates."""


class Timed(Robot):
    """A robot that records when each motion was sent and accepted (s, monotonic)."""

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot.name, robot.side, client=robot.client)
        self.brackets: list[tuple[float, float]] = []

    def begin(self, query: MotionQuery | PoseQuery) -> Motion:
        """Begin a motion as `Robot.begin` does, and record its times."""
        sent_s = time.monotonic()
        motion = super().begin(query)
        self.brackets.append((sent_s, time.monotonic()))
        return motion


def played(twin: Twin) -> tuple[list[Positions], list[Positions]]:
    """Calibrate both robots and play the choreography of the demo; return the positions of simulation and hardware."""
    twin.enable()
    twin.calibrate()
    streams = [robot.positions_stream() for robot in (twin.sim, twin.hw)]
    kept: tuple[list[Positions], list[Positions]] = ([], [])
    time.sleep(SETTLE_S)
    play(twin, shipped("demo"))
    time.sleep(SETTLE_S)
    for i, stream in enumerate(streams):
        kept[i].extend(stream.take())
        stream.close()
    return kept


def begins(positions: Sequence[Positions], brackets: Sequence[tuple[float, float]]) -> list[float]:
    """Return the start time of each motion (s), computed from distance = a/2 t^2 for an arm that starts at rest.

    The arm that moves furthest accelerates at the limit. The result is the mean over its samples within EARLY_DEG.
    """
    recorded = recording(positions)
    assert recorded.commanded is not None
    found = []
    for sent_s, _ in brackets:
        rest = int(np.searchsorted(recorded.t, sent_s)) - 1
        coming = slice(rest, rest + 30)
        ways = np.abs(recorded.commanded[coming] - recorded.commanded[rest])
        way = ways[:, int(np.argmax(ways[-1]))]
        early = (way > EARLY_DEG[0]) & (way < EARLY_DEG[1])
        # Subtract half a microstep, by which the step counter leads in the direction of travel on average.
        microstep = (
            360
            / ROBOT.drive.full_steps
            / ROBOT.drive.microsteps
            * ROBOT.drive.gear_pinion
            / ROBOT.drive.gear_ring
        )
        since = np.sqrt(2 * (way[early] - microstep / 2) / ROBOT.limits.acceleration)
        found.append(float(np.mean(recorded.t[coming][early] - since)))
    return found


def print_twin(sim: Sequence[Positions], hw: Sequence[Positions], robots: tuple[Timed, Timed]) -> None:
    """Print the differences between both robots, and between the simulation and its set points."""
    found = compare(recording(sim), recording(hw))
    print(axes_table(found.axes))
    lags = [part.lag_s * 1e3 for part in found.moved]
    print(
        f"lag of the set points: {found.lag_s * 1e3:.1f} ms; of the positions, {len(lags)} motions: {min(lags):.1f} to {max(lags):.1f} ms"
    )
    largest = max(found.axes, key=lambda axis: axis.rms_after)
    print(f"largest rms after each motion's own lag: {largest.rms_after:.3f}° ({largest.axis})")
    once = rms_after_one_lag(recording(sim), recording(hw))
    print(f"largest rms after one lag for all motions: {once:.3f}°")
    own = recording(sim)
    print(
        f"simulated arms behind their own set points: {lag(own.arms, own) * 1e3:.1f} ms; at rest up to {found.off_set_points[0]:.3f}° off them"
    )
    print(f"hardware at rest off its set points: {found.off_set_points[1]:.3f}° (it counts its own steps)")
    began = [begins(positions, robot.brackets) for robot, positions in zip(robots, (sim, hw), strict=True)]
    for robot, each in zip(robots, began, strict=True):
        after = [(begin_s - sent_s) * 1e3 for begin_s, (sent_s, _) in zip(each, robot.brackets, strict=True)]
        took = statistics.median((end_s - sent_s) * 1e3 for sent_s, end_s in robot.brackets)
        print(
            f"{robot}: motions were accepted after {took:.1f} ms (median) and began, by their time stamps, {min(after):.1f} to "
            f"{max(after):.1f} ms after they were sent"
        )
    first, second = recording(sim).arms, recording(hw).arms
    parts = aligned(first, second).parts
    by_law = [b - a for a, b in zip(*began, strict=True)]
    if len(parts) == len(by_law):
        apart = max(abs(part.lag_s - lag_s) for part, lag_s in zip(parts, by_law, strict=True))
        print(
            f"lag of each motion by comparison, against that of its first degrees: at most {apart * 1e3:.1f} ms apart"
        )


def lag(first: Recording, second: Recording) -> float:
    """Return the lag (s), up to NEAR_S, of the set points or positions of the second behind the first."""
    t = np.arange(first.t[0] + NEAR_S, first.t[-1] - NEAR_S, 0.01)
    one, other = (replace(each, angles=each.angles[:, : len(ARMS)]) for each in (first, second))
    return best_shift(one, other, t, 0.0, NEAR_S).s


def rms_after_one_lag(first: Recording, second: Recording) -> float:
    """Return the largest rms difference of an axis (deg) after the same lag was removed from all motions."""
    late = Recording(second.t - lag(first, second), second.angles)
    t = np.arange(max(first.t[0], late.t[0]), min(first.t[-1], late.t[-1]), 0.01)
    apart = [
        np.interp(t, late.t, b) - np.interp(t, first.t, a)
        for a, b in zip(first.angles.T, late.angles.T, strict=True)
    ]
    return max(float(np.sqrt(np.mean(np.square(each)))) for each in apart)


def print_replay(hw: Robot, done: Sequence[Positions]) -> None:
    """Replay the recorded motion on the hardware, and print the differences."""
    moved = recording(done).arms
    following = follow(path_of_recording("demo", moved.t, moved.angles), ROBOT)
    with hw.positions_stream() as stream:
        replay(hw, following)
        time.sleep(SETTLE_S)
        again = recording(stream.take())
    t: Floats = np.arange(-SETTLE_S, following.path.duration_s + SETTLE_S, 0.01)
    path = following.path.at(t)
    first = Recording(t + begun(again, following.path.at(t), t), np.hstack([path, path]))
    found = compare(first, Recording(again.t, np.hstack([again.arms.angles, again.arms.angles])))
    arms = found.axes[:3]
    print(
        f"replay of {following.path.duration_s:.1f} s, {len(following.targets)} targets: planned within {following.off_deg:.2f}°; "
        f"made with rms {max(axis.rms_after for axis in arms):.3f}°, largest {max(axis.largest_after for axis in arms):.2f}°"
    )


def begun(again: Recording, path: Floats, t: Floats) -> float:
    """Return the time (s) to add to the times of the path so that path and replay begin to move at the same time."""
    moved = int(np.argmax(np.max(np.abs(again.arms.angles - again.arms.angles[0]), axis=1) > 1.0))
    planned = int(np.argmax(np.max(np.abs(path - path[0]), axis=1) > 1.0))
    return float(again.t[moved] - t[planned])


def main() -> None:
    """Compare both robots, then replay."""
    with signals_interrupt(), Supervisor() as supervisor:
        settings = start(supervisor)
        supervisor.wait_ready()
        with Twin("demo", connect=settings.connect, who=settings.who) as twin, suppress(KeyboardInterrupt):
            robots = Timed(twin.sim), Timed(twin.hw)
            twin.sim, twin.hw = robots
            sim, hw = played(twin)
            print_twin(sim, hw, robots)
            plant = twin.sim.status().plant
            if plant is not None:
                print(
                    f"simulation: real-time factor {plant.real_time_factor:.4f}, {plant.late_steps} late steps, {plant.slipped_steps} slipped"
                )
            print_replay(twin.hw, hw)


if __name__ == "__main__":
    main()
