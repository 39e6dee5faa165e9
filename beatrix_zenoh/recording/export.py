"""A recording as a table: one row every 20 ms with all robots side by side.

Tables are made in blocks of rows, so that a long recording of a class needs little memory. Numbers that are missing are NaN.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.rows import GAP_NS, GRID_NS
from beatrix_zenoh.recording.samples import (
    Floats,
    Nanoseconds,
    Note,
    Recorded,
    Samples,
    TimedEvent,
)
from beatrix_zenoh.recording.series import HEAD

BLOCK: Final = 3000
"""Rows of a block: one minute of the grid."""
DECIMALS: Final = 6
"""Decimals of interpolated values: finer than the float32 of a robot's message, and still short as text."""
FORMULA: Final = ("=", "+", "-", "@", "\t")
"""Beginnings of formulas in a spreadsheet."""

Block = dict[str, Floats | list[str | None]]
"""Columns of equal length by name."""


@dataclass(frozen=True)
class Table:
    """The samples of a recording and the part of it that is exported."""

    robots: dict[Place, Samples]
    start_ns: int
    """start of the recording, since 1970: the point of the grid at or before the first sample"""
    first_ns: int
    """first time of the exported part"""
    last_ns: int
    """last time of the exported part"""
    notes: tuple[Note, ...] = ()
    """notes of this part in the order of time; those before and after all samples belong to its ends"""
    events: Mapping[Place, tuple[TimedEvent, ...]] = field(default_factory=dict)
    """events of these robots in this part, in the order of time; those before and after all samples belong to its ends"""

    def grid(self) -> Iterator[Block]:
        """Yield one row for each point of the grid of 20 ms, with the robots side by side."""
        first = -(-(self.first_ns - self.start_ns) // GRID_NS)
        last = (self.last_ns - self.start_ns) // GRID_NS
        texts = self._notes_by_step(first, last)
        for begin in range(first, last + 1, BLOCK):
            steps = np.arange(begin, min(begin + BLOCK, last + 1), dtype=np.int64)
            times = self.start_ns + steps * GRID_NS
            block: Block = {
                "time_s": np.round(steps * (GRID_NS / 1e9), 2),
                "unix_time_s": np.round(times / 1e9, 3),
            }
            if self.notes:
                block["note"] = [texts.get(step) for step in steps.tolist()]
            for (name, side), samples in self.robots.items():
                for column, values in quantities(samples):
                    if not np.isnan(values).all():  # it was recorded
                        circle = column.endswith(HEAD_NAMES)
                        block[f"{name}_{side}_{column}"] = at(samples.time_ns, values, times, circle=circle)
            yield block

    def _notes_by_step(self, first: int, last: int) -> dict[int, str]:
        """Return the texts of the notes by the step of the grid at or after them, within the first and the last step."""
        texts: dict[int, str] = {}
        for note in self.notes:
            step = min(max(-(-(note.time_ns - self.start_ns) // GRID_NS), first), last)
            text = " ".join(note.text.splitlines())  # some programs read a table line by line
            if text.startswith(FORMULA):
                text = f" {text}"  # a spreadsheet would execute it
            texts[step] = f"{texts[step]}; {text}" if step in texts else text
        return texts


HEAD_NAMES: Final = tuple(f"{axis}{what}_deg" for axis in HEAD for what in ("", "_measured"))


def table(
    recorded: Recorded, from_s: float = 0.0, to_s: float = math.inf, names: Sequence[str] = ()
) -> Table:
    """Return the table of a recording for robots of these names; all robots if there is none.

    `from_s`, `to_s`: the exported part, in seconds from the start of the recording; both ends are included.

    Raises:
        Refused: BAD_VALUE, no such robot, or no sample from `from_s` on.
    """
    robots = recorded.robots
    chosen = {place: samples for place, samples in robots.items() if not names or place[0] in names}
    if missing := sorted(set(names) - {name for name, _ in chosen}):
        held = ", ".join(sorted({name for name, _ in robots}))
        raise bad_value(
            f"The recording contains {held}, and not {', '.join(missing)}: give another --name.",
        )
    first_ns = min(int(samples.time_ns[0]) for samples in robots.values())
    last_ns = max(int(samples.time_ns[-1]) for samples in robots.values())
    start_ns = first_ns // GRID_NS * GRID_NS
    lasts_s = (last_ns - start_ns) / 1e9
    if from_s > lasts_s:
        raise bad_value(
            f"The recording lasts {lasts_s:.1f} s and has no samples from {from_s:g} s on: give a smaller --from.",
        )
    from_ns = max(first_ns, start_ns + round(from_s * 1e9))
    to_ns = min(last_ns, start_ns + round(min(to_s, lasts_s) * 1e9))

    def inside(time_ns: int) -> bool:
        return (not from_s or time_ns >= from_ns) and (to_s > lasts_s or time_ns <= to_ns)

    notes = tuple(note for note in recorded.notes if inside(note.time_ns))
    events = {
        place: tuple(one for one in recorded.events.get(place, ()) if inside(one.time_ns)) for place in chosen
    }
    return Table(chosen, start_ns, from_ns, to_ns, notes, events)


def quantities(samples: Samples) -> Iterator[tuple[str, Floats]]:
    """Yield name and values (n,) of each quantity; NaN where it was not recorded."""
    for axes, values, name in (
        (ARMS, samples.arms, "{}_deg"),
        (ARMS, samples.commanded, "{}_commanded_deg"),
        (ARMS, samples.velocity, "{}_velocity_deg_s"),
        (HEAD, samples.head, "{}_deg"),
        (HEAD, samples.head_measured, "{}_measured_deg"),
    ):
        for index, axis in enumerate(axes):
            yield name.format(axis), values[:, index]


def at(samples_ns: Nanoseconds, values: Floats, times_ns: Nanoseconds, *, circle: bool = False) -> Floats:
    """Return values at other times, interpolated linearly between neighbours; NaN outside them and in gaps.

    Args:
        samples_ns: (n,) ascending times of the samples.
        values: (n,) values of the samples.
        times_ns: (m,) times in question.
        circle: whether values are degrees of a circle, which take the short way through ±180.
    """
    known = ~np.isnan(values)
    t, values = samples_ns[known], values[known]
    before = np.searchsorted(t, times_ns, side="right") - 1
    after = np.searchsorted(t, times_ns)
    inside = (before >= 0) & (after < len(t))
    gaps_ns = t[np.minimum(after, len(t) - 1)] - t[np.maximum(before, 0)]
    found = np.interp(times_ns - t[0], t - t[0], np.unwrap(values, period=360.0) if circle else values)
    if circle:
        found = (found + 180.0) % 360.0 - 180.0
    result: Floats = np.where(inside & (gaps_ns <= GAP_NS), found, np.nan)
    return np.round(result, DECIMALS)


PARQUET: Final = ".parquet"


def write_table(path: Path, blocks: Iterable[Block]) -> int:
    """Write a table in the format of the path's ending, and return the number of rows; raises OSError.

    CSV is UTF-8 with commas, decimal points and one line of names. A missing value is an empty field, and null in Parquet.
    """
    rows, writer = 0, None
    with path.open("wb") as file:
        for block in blocks:
            batch = record_batch(block)
            if writer is None and path.suffix.lower() == PARQUET:
                writer = pyarrow.parquet.ParquetWriter(file, batch.schema)
            elif writer is None:
                file.write((",".join(batch.schema.names) + "\n").encode())  # pyarrow would quote the names
                quotes = "needed" if "note" in block else "none"  # pyarrow needs quotes for every text
                options = pyarrow.csv.WriteOptions(include_header=False, quoting_style=quotes)
                writer = pyarrow.csv.CSVWriter(file, batch.schema, write_options=options)
            writer.write_batch(batch)
            rows += batch.num_rows
        if writer is not None:
            writer.close()
    return rows


def record_batch(block: Block) -> pa.RecordBatch:
    """Return a block as columns of Arrow, with null for NaN."""
    columns = {}
    for name, values in block.items():
        if isinstance(values, list):
            columns[name] = pa.array(values, pa.string())
        else:
            # Adding 0 turns -0.0, which would be "-0" in a cell, into 0.
            columns[name] = pa.array(values + 0.0, mask=np.isnan(values))
    return pa.RecordBatch.from_pydict(columns)
