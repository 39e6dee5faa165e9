"""What `beatrix demo` found: figures, table, files."""

from __future__ import annotations

import csv
import itertools
import math
import statistics
import subprocess
import sys
from pathlib import Path

import msgspec

from beatrix_zenoh.cli.show import Performance, Record
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.compare import AXES, AxisDifference, Comparison, compare, recording

BUSY_FACTOR = 0.98
"""Simulated seconds a second, below which the simulation was held up."""
REST_DEG = 0.5
"""Further apart at rest, it was not the same movement; a full motor step is 0.7 deg of an arm."""
PICTURE_S = 30.0
GREETING = (-35.0, 4.0, 10.0)
"""Yaw, pitch and roll of the head in the picture, deg: at the one who looks."""
DRAW = """
import math, sys
from pathlib import Path
from beatrix_zenoh.kinematics import Neck
from sim_node.picture import write_picture
write_picture(Path(sys.argv[1]), Neck().inverse(*(math.radians(float(angle)) for angle in sys.argv[2:])))
"""


ROBOT_HEADS = ("robot", "accepted after ms", "longest ms", "positions/s", "sd of period ms")


class RobotFigures(msgspec.Struct, frozen=True):
    """One robot; times in ms, of queries to their `accepted` and between positions."""

    accepted_median_ms: float
    accepted_longest_ms: float
    positions_hz: float
    period_sd_ms: float


class Report(msgspec.Struct, frozen=True):
    """Both robots."""

    result: bool
    message: str
    lag_ms: float
    """hardware behind simulation"""
    axes: tuple[AxisDifference, ...]
    """hardware - simulation, deg"""
    real_time_factor: float
    late_steps: int
    sim: RobotFigures
    hw: RobotFigures
    files: list[str]


def reported(done: Performance, comparison: Comparison, files: list[str]) -> Report:
    """The figures of a performance."""
    apart = comparison.arms_at_rest
    same = apart <= REST_DEG
    verdict = "Both made the same movement" if same else "They did NOT make the same movement"
    factor = done.plant.real_time_factor if done.plant else math.nan
    if not same and factor < BUSY_FACTOR:
        verdict = (
            f"This computer was too busy to tell ({factor:.2f} of real time): close other programs, try again"
        )
    return Report(
        result=same,
        message=f"{verdict}: at rest the arms are at most {apart:.2f}° apart ({REST_DEG:g}° allowed).",
        lag_ms=comparison.lag_s * 1e3,
        axes=comparison.axes,
        real_time_factor=factor,
        late_steps=done.plant.late_steps if done.plant else 0,
        sim=figures(done.sim),
        hw=figures(done.hw),
        files=files,
    )


def compared(done: Performance) -> Comparison:
    """Hardware against simulation; both clocks are this computer's."""
    return compare(recording(done.sim.positions), recording(done.hw.positions))


def figures(record: Record) -> RobotFigures:
    """Latencies and rate of one robot."""
    times = [positions.t_mono_ns / 1e6 for positions in record.positions]
    periods = [b - a for a, b in itertools.pairwise(times)]
    return RobotFigures(
        accepted_median_ms=statistics.median(record.accepted_s) * 1e3,
        accepted_longest_ms=max(record.accepted_s) * 1e3,
        positions_hz=1e3 / statistics.fmean(periods),
        period_sd_ms=statistics.pstdev(periods),
    )


def text(report: Report) -> str:
    """The report for people."""
    heads = ("hardware - simulation", "largest°", "rms°", "at rest°")
    rows = [
        (axis.axis, *(f"{value:.2f}" for value in (axis.largest, axis.rms, axis.at_rest)))
        for axis in report.axes
    ]
    behind = "behind" if report.lag_ms >= 0 else "ahead of"
    busy = ": this computer was busy" if report.late_steps else ""
    return "\n".join([
        columns(heads, rows),
        "",
        columns(ROBOT_HEADS, [robot_row("simulation", report.sim), robot_row("hardware", report.hw)]),
        "",
        f"The hardware was {abs(report.lag_ms):.1f} ms {behind} the simulation.",
        f"The simulation ran at {report.real_time_factor:.3f} of real time, {report.late_steps} physics steps late{busy}.",
        f"Look at {', '.join(report.files)}.",
        "",
        report.message,
    ])  # fmt: skip


def robot_row(name: str, robot: RobotFigures) -> tuple[str, ...]:
    """A line of the second table."""
    return (
        name,
        f"{robot.accepted_median_ms:.1f}",
        f"{robot.accepted_longest_ms:.1f}",
        f"{robot.positions_hz:.1f}",
        f"{robot.period_sd_ms:.2f}",
    )


def write_csv(path: Path, found: Comparison) -> None:
    """Both movements every 10 ms, deg."""
    names = [f"{robot}_{axis}_deg" for robot in ("sim", "hw") for axis in AXES]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["t_s", *names])
        for t, sim, hw in zip(found.t - found.t[0], found.first, found.second, strict=True):
            writer.writerow([f"{t:.3f}", *(f"{angle:.4f}" for angle in (*sim, *hw))])


def draw_head(path: Path) -> str:
    """A picture of the simulated head by a process of the simulation; why not, or nothing."""
    command = [sys.executable, "-c", DRAW, str(path), *map(str, GREETING)]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PICTURE_S, check=False
        )
    except subprocess.TimeoutExpired:
        return f"not drawn within {PICTURE_S:.0f} s"
    return "" if done.returncode == 0 else (done.stderr.strip().splitlines() or ["no reason given"])[-1]
