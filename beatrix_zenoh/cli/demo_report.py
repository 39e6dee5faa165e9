"""The movement of `beatrix demo`, measured, and the report about it."""

from __future__ import annotations

import contextlib
import itertools
import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import msgspec

from beatrix_zenoh.cli.comparison_text import AFTER, axes_table, lag_sentence
from beatrix_zenoh.cli.demo_files import Files
from beatrix_zenoh.client.choreography import Choreography, Step
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.play import play
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.subscription import Subscription
from beatrix_zenoh.client.twin.twin import Twin
from beatrix_zenoh.contract._generated.messages import MotionQuery, PlantStatus, PoseQuery, Positions
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.output import columns
from beatrix_zenoh.recording.compare import AxisDifference, Comparison, compare
from beatrix_zenoh.recording.series import recording

SETTLE_S = 0.5
"""Time at rest before and after the movement (s)."""
BUSY_FACTOR = 0.98
"""Simulated seconds per second; below this the computer was too busy for the simulation."""
REST_DEG = 0.5
"""Largest difference at rest (deg) that counts as the same movement; a full motor step is 0.7 deg of an arm."""
ROBOT_HEADS = ("robot", "accepted after ms", "longest ms", "positions/s", "sd of period ms")


class TimedRobot(Robot):
    """A robot that measures the time from each motion query to its acceptance."""

    accepted_s: list[float]

    @classmethod
    def of(cls, robot: Robot) -> TimedRobot:
        """Return a timed robot with the name, side and session of `robot`."""
        timed = cls(robot.name, robot.side, client=robot.client)
        timed.accepted_s = []
        return timed

    def begin(self, query: MotionQuery | PoseQuery) -> Motion:
        """Begin a motion as `Robot.begin` does, and record the time until it is accepted (s)."""
        begin_s = time.perf_counter()
        motion = super().begin(query)
        self.accepted_s.append(time.perf_counter() - begin_s)
        return motion


@dataclass
class Measured:
    """Positions of one robot, and the times from motion queries to their acceptance (s)."""

    positions: list[Positions] = field(default_factory=list)
    accepted_s: list[float] = field(default_factory=list)


@dataclass
class Measurement:
    """Measured data of both robots, and the status of the plant."""

    sim: Measured
    hw: Measured
    plant: PlantStatus | None


def measure(twin: Twin, choreography: Choreography, show_step: Callable[[str, Step], None]) -> Measurement:
    """Enable and calibrate both robots, play the choreography and measure; stop both if anything fails.

    Raises:
        Refused, Interrupted, NoAnswer: from the first step that failed.
    """
    sim, hw = TimedRobot.of(twin.sim), TimedRobot.of(twin.hw)
    twin.sim, twin.hw = sim, hw
    twin.enable()
    twin.calibrate()
    streams = [(robot.positions_stream(), Measured()) for robot in (sim, hw)]

    def take_and_show(title: str, pose: Step) -> None:
        take_positions(streams)
        show_step(title, pose)

    try:
        time.sleep(SETTLE_S)
        play(twin, choreography, take_and_show)
        time.sleep(SETTLE_S)
    except BaseException:
        with contextlib.suppress(BeatrixError):
            twin.stop()
        raise
    take_positions(streams)
    (_, of_sim), (_, of_hw) = streams
    of_sim.accepted_s, of_hw.accepted_s = sim.accepted_s, hw.accepted_s
    return Measurement(of_sim, of_hw, sim.status().plant)


def take_positions(streams: list[tuple[Subscription[Positions], Measured]]) -> None:
    """Append the queued positions to the records, before the subscriptions discard them."""
    for subscription, record in streams:
        record.positions += subscription.take()


class RobotFigures(msgspec.Struct, frozen=True):
    """Times of one robot from query to `accepted`, and rate and standard deviation of the period of its positions."""

    accepted_median_ms: float
    accepted_longest_ms: float
    positions_hz: float
    period_sd_ms: float


class Report(msgspec.Struct, frozen=True):
    """The figures of both robots and the verdict."""

    result: bool
    message: str
    lag_ms: float
    """lag of the hardware's set points behind those of the simulation"""
    lag: str
    """a sentence with the lag of the recording and of each motion"""
    axes: tuple[AxisDifference, ...]
    """hardware - simulation (deg); "after": each motion of the hardware is shifted by its own lag"""
    real_time_factor: float
    late_steps: int
    sim: RobotFigures
    hw: RobotFigures
    files: list[str]
    unwritten: list[str]
    """a sentence for each file that could not be written"""


def make_report(done: Measurement, comparison: Comparison, files: Files) -> Report:
    """Return the figures and the verdict."""
    apart = comparison.arms_at_rest
    same = apart <= REST_DEG
    verdict = "Both made the same movement" if same else "They did NOT make the same movement"
    factor = done.plant.real_time_factor if done.plant else math.nan
    if not same and factor < BUSY_FACTOR:
        verdict = f"This computer was too busy for a result ({factor:.2f} of real time): close other programs and try again"
    return Report(
        result=same,
        message=f"{verdict}: at rest the arms are at most {apart:.2f}° apart ({REST_DEG:g}° allowed).",
        lag_ms=comparison.lag_s * 1e3,
        lag=lag_sentence(comparison),
        axes=comparison.axes,
        real_time_factor=factor,
        late_steps=done.plant.late_steps if done.plant else 0,
        sim=figures(done.sim),
        hw=figures(done.hw),
        files=files.written,
        unwritten=files.failures,
    )


def compare_twins(done: Measurement) -> Comparison:
    """Compare the hardware with the simulation; both run on this computer and share its clock."""
    return compare(recording(done.sim.positions), recording(done.hw.positions))


def figures(measured: Measured) -> RobotFigures:
    """Return the figures of one robot."""
    times = [positions.t_mono_ns / 1e6 for positions in measured.positions]
    periods = [b - a for a, b in itertools.pairwise(times)]
    return RobotFigures(
        accepted_median_ms=statistics.median(measured.accepted_s) * 1e3,
        accepted_longest_ms=max(measured.accepted_s) * 1e3,
        positions_hz=1e3 / statistics.fmean(periods),
        period_sd_ms=statistics.pstdev(periods),
    )


def as_text(report: Report) -> str:
    """Return the report as text."""
    busy = ": this computer was busy" if report.late_steps else ""
    return "\n".join([
        axes_table(report.axes),
        AFTER,
        "",
        columns(ROBOT_HEADS, [robot_row("simulation", report.sim), robot_row("hardware", report.hw)]),
        "",
        report.lag,
        f"The simulation ran at {report.real_time_factor:.3f} of real time, with {report.late_steps} late physics steps{busy}.",
        *([f"Files: {', '.join(report.files)}."] if report.files else []),
        *report.unwritten,
        "",
        report.message,
    ])  # fmt: skip


def robot_row(name: str, robot: RobotFigures) -> tuple[str, ...]:
    """Return the row of one robot in the table of times and rates."""
    return (
        name,
        f"{robot.accepted_median_ms:.1f}",
        f"{robot.accepted_longest_ms:.1f}",
        f"{robot.positions_hz:.1f}",
        f"{robot.period_sd_ms:.2f}",
    )
