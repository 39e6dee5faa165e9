"""Recordings that tests write, without robots."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.recording.rows import Numbers, RecordingRow, RobotSet, of_robot
from beatrix_zenoh.recording.rrd.stream import RowStream
from beatrix_zenoh.recording.samples import About

BEGAN_NS = 1_763_000_000_000_000_000
STEP_NS = 20_000_000


def write_lesson(
    path: Path,
    places: Sequence[Place],
    rows: int = 300,
    more: Sequence[RecordingRow] = (),
    about: About | None = None,
) -> None:
    """Write a recording of robots with random angles, which are float32 in rad as in their messages, every 20 ms."""
    stream = RowStream(f"one {path.stem}", path.stem)
    stream.to_file(path)
    stream.show(RobotSet({place: Figure() for place in places}))
    angles = np.random.default_rng(1).normal(0.0, 0.5, (rows, 3)).astype(np.float32)
    for place in places:
        for what in ("arms", "commanded", "head"):
            stream.send([
                Numbers(of_robot(place, what), time_ns, tuple(np.degrees(row).tolist()), time_ns)
                for time_ns, row in zip(times(rows), angles.astype(np.float64), strict=True)
            ])  # fmt: skip
    stream.send(more)
    if about is not None:
        stream.describe(about)
    assert stream.flush(30.0)
    stream.close()


def times(rows: int) -> list[int]:
    """Return the times of the rows (ns since 1970)."""
    return [BEGAN_NS + index * STEP_NS for index in range(rows)]
