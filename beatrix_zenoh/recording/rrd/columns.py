"""The rows of a recording's file as columns, also after Rerun's own program has split, filtered or merged the file."""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from rerun.chunk import Chunk, RrdReader
from rerun.error_utils import RerunWarning

from beatrix_zenoh.contract.errors import Refused, bad_value
from beatrix_zenoh.output import typed
from beatrix_zenoh.recording.samples import Nanoseconds
from beatrix_zenoh.recording.viewer import check_recording

TIME, ROBOT_TIME = "time", "robot_time"
SCALARS = "Scalars:scalars"
EVENT = "event"
"""Component with the events as JSON."""
BLOB, PCM, RATE, NUMBER = "EncodedImage:blob", "pcm", "rate", "number"
PROPERTY, ABOUT = "beatrix", "about"
"""Property of a recording, and its component with `About` as JSON."""
ABOUT_ENTITY = f"/__properties/{PROPERTY}"

TIMESTAMP: Final = "timestamp[ns]"
TYPES: Final = {
    SCALARS: "double",
    BLOB: "list<item: uint8",
    PCM: "binary",
    **dict.fromkeys((RATE, NUMBER), "int64"),
    **dict.fromkeys((EVENT, ABOUT), "string"),
}
"""How the Arrow type of each component's values begins."""
ALWAYS: Final = (0, 2**63 - 1)

Components = Mapping[str, int]
"""Components, and the number of values in each of their rows."""
Key = tuple[str, str]
"""An entity and a component."""


class Column(NamedTuple):
    """Rows of one component of one entity: times (n,) and values (n, k), which are numbers, texts or bytes."""

    time_ns: Nanoseconds
    robot_ns: Nanoseconds
    """-1: the entity does not have these times, or another program has dropped them"""
    values: npt.NDArray[np.float64] | npt.NDArray[np.object_]


Columns = dict[Key, Column]


def rows(
    path: Path,
    wanted: Callable[[str], Components],
    entities: Sequence[str] = (),
    between: tuple[int, int] = ALWAYS,
) -> Iterator[tuple[int, Key, Column]]:
    """Yield parts of the columns, in any order, with the number of their recording: a file may contain several.

    Args:
        path: the file.
        wanted: returns which components of an entity are read.
        entities: only these are read, which is faster than to read all.
        between: the first and the last time (ns since 1970).

    Raises:
        WrongUsage: there is no such file.
        Refused: BAD_VALUE, the file is damaged or not a recording of BEATRIX.
    """
    for number, chunk in _chunks(path, entities):
        components = wanted(chunk.entity_path)
        if not components or chunk.is_static != (chunk.entity_path == ABOUT_ENTITY):
            continue
        batch = chunk.to_record_batch()
        kinds = {field.name: str(field.type) for field in batch.schema}
        times, robot = (
            batch.column(name).cast("int64").to_numpy(zero_copy_only=False) if kinds.get(name) == TIMESTAMP else None
            for name in (TIME, ROBOT_TIME)
        )  # fmt: skip
        if chunk.is_static:  # Rerun keeps the row that was written last
            times = _written_at(batch.column("rerun.controls.RowId").to_pylist())
        if times is None:
            continue
        robot = np.full_like(times, -1) if robot is None else robot
        inside = (times >= between[0]) & (times <= between[1])
        # Rerun's program puts components into chunks of their own.
        for component in components.keys() & kinds.keys() if inside.any() else ():
            column, width = batch.column(component), components[component]
            lengths = column.value_lengths().fill_null(0).to_numpy(zero_copy_only=False)
            there, flat = lengths > 0, column.flatten()
            fits = flat.null_count == 0 and np.all(lengths[there] == width)
            if not fits or not str(flat.type).startswith(TYPES[component]):
                raise foreign(str(path), chunk.entity_path)
            values = flat.to_numpy(zero_copy_only=False)
            if component == BLOB:
                values = np.array([each.tobytes() for each in values], np.object_)
            kept = inside[there]
            if kept.any():
                found = Column(times[there][kept], robot[there][kept], values.reshape(-1, width)[kept])
                yield number, (chunk.entity_path, component), found


def _written_at(row_ids: Sequence[bytes]) -> Nanoseconds:
    """Return the times at which rows were written, which are the first half of their numbers."""
    return np.array([int.from_bytes(row[:8], "big") for row in row_ids], np.int64)


def _chunks(path: Path, entities: Sequence[str]) -> Iterator[tuple[int, Chunk]]:
    """Yield the chunks of a file with the number of their recording; raises the errors of `rows`."""
    check_recording(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RerunWarning)  # a killed recorder leaves a file without its end
            reader = RrdReader(path)
            streams = [reader.stream(store=store) for store in reader.recordings()]
        for number, stream in enumerate(streams):
            for chunk in stream.filter(content=list(entities)) if entities else stream:
                yield number, chunk
    except (ValueError, OSError, RuntimeError) as error:
        raise bad_value(
            f"{path} is damaged ({str(error).splitlines()[0].rpartition(': ')[2]}): its recorder was killed, the disk was full, or "
            f"the file was copied only in part. `{typed('beatrix', 'record', '--repair', path)}` keeps all readable data.",
        ) from error


def foreign(files: str, entity: str) -> Refused:
    """Return the error for rows that `beatrix record` does not write."""
    return bad_value(
        f"{files}: the rows of {entity} are not as `beatrix record` of this version writes them. Use the original file of the "
        "recorder, or update BEATRIX if a newer version recorded it.",
    )


def joined(parts: Iterable[tuple[Key, Column]]) -> Columns:
    """Return whole columns in the order of time."""
    found: dict[Key, list[Column]] = defaultdict(list)
    for key, part in parts:
        found[key].append(part)
    return {key: _joined(pieces) for key, pieces in found.items()}


def _joined(parts: Sequence[Column]) -> Column:
    times, robot, values = (np.concatenate(pieces) for pieces in zip(*parts, strict=True))
    order = np.argsort(times, kind="stable")
    times, robot, values = times[order], robot[order], values[order]
    # Each file of `rerun rrd split` begins with the last row before the cut again.
    again = (times[1:] == times[:-1]) & (values[1:] == values[:-1]).all(axis=1)
    kept = np.append(True, ~again)
    return Column(times[kept], robot[kept], values[kept])
