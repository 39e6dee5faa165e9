"""Read a recording."""

from __future__ import annotations

import contextlib
import itertools
import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from rerun.chunk import Chunk, RrdReader
from rerun.error_utils import RerunWarning

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import Event, Reason
from beatrix_zenoh.contract.codec import decode_json
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import EYES, SIDES
from beatrix_zenoh.output import typed
from beatrix_zenoh.recording.about import About
from beatrix_zenoh.recording.rows import NOTES, of_robot
from beatrix_zenoh.recording.samples import (
    ClockOffset,
    EyePicture,
    EyePictures,
    Floats,
    Nanoseconds,
    Note,
    Recorded,
    Samples,
    TimedEvent,
    TimedTexts,
)
from beatrix_zenoh.recording.sound import RecordedBlock
from beatrix_zenoh.recording.viewer import check_recording

TIME, ROBOT_TIME = "time", "robot_time"
SCALARS, TEXT, STATE = "Scalars:scalars", "TextLog:text", "StateChange:state"
EVENT = "event"
"""Component with the events as JSON."""
PROPERTY, ABOUT = "beatrix", "about"
"""Property of a recording, and its component with `About` as JSON."""
ABOUT_ENTITY = f"/__properties/{PROPERTY}"


class Column(NamedTuple):
    """All rows of one component of one entity: times (n,) and values, (n, k) numbers or (n,) texts."""

    time_ns: Nanoseconds
    robot_ns: Nanoseconds
    values: npt.NDArray[np.float64] | npt.NDArray[np.object_]


Columns = dict[tuple[str, str], Column]
"""Columns by entity and component."""
SoundBlocks = dict[Place, list[RecordedBlock]]


def read(path: Path) -> Recorded:
    """Read a recording, even if its recorder was killed.

    Raises:
        WrongUsage: there is no such file.
        Refused: BAD_VALUE, the file is damaged or not a recording of BEATRIX.
    """
    columns = _columns(path)
    robots: dict[Place, Samples] = {}
    for name, side, what in [_parts(entity) for entity, component in columns if component == SCALARS]:
        root = f"/{name}/{side}"
        # A recorder that was killed just after its start may have written only some of these columns.
        whole = all((f"{root}/{other}", SCALARS) in columns for other in ("commanded", "head"))
        if side in SIDES and what == "arms" and whole:
            robots[name, side] = _samples(columns, root)
    if not robots:
        raise Refused(
            Reason.BAD_VALUE, f"{path} contains no positions of a robot. `beatrix record` writes recordings."
        )
    names = sorted({name for name, _ in robots})
    return Recorded(
        dict(sorted(robots.items())),
        {name: found for name in names if (found := _difference(columns, name)) is not None},
        {place: _texts(columns, "/{}/{}/events".format(*place), TEXT) for place in robots},
        {place: _texts(columns, "/{}/{}/state".format(*place), STATE) for place in robots},
        {place: _events(columns, "/{}/{}/events".format(*place)) for place in robots},
        {place: _clocks(columns, "/{}/{}/clock".format(*place)) for place in robots},
        _notes(columns),
        _about(columns),
    )


def read_about(path: Path) -> About | None:
    """Return what a recording says of itself, without reading its data; raises the errors of `read`."""
    with _opened(path, ABOUT_ENTITY) as chunks:
        parts = [_static(chunk) for chunk in chunks if chunk.is_static]
    return _latest(max(parts, key=lambda column: int(column.time_ns[-1]))) if parts else None


def holds_samples(path: Path) -> bool:
    """Return whether a recording contains positions of any robot; False if it cannot be read."""
    try:
        return bool(read(path).robots)
    except Refused:
        return False


def _columns(path: Path) -> Columns:
    found: dict[tuple[str, str], list[Column]] = defaultdict(list)
    for entity, component, column in _chunks(path):
        found[entity, component].append(column)
    joined = {}
    for key, parts in found.items():
        times, robot, values = (np.concatenate(pieces) for pieces in zip(*parts, strict=True))
        order = np.argsort(times, kind="stable")
        joined[key] = Column(times[order], robot[order], values[order])
    return joined


def _chunks(path: Path) -> Iterator[tuple[str, str, Column]]:
    """Yield entity, component and rows of each column of each chunk that has times, and of the description."""
    with _opened(path) as chunks:
        for chunk in chunks:
            if chunk.is_static and chunk.entity_path == ABOUT_ENTITY:
                yield ABOUT_ENTITY, ABOUT, _static(chunk)
            if chunk.is_static or TIME not in chunk.timeline_names:
                continue
            batch = chunk.to_record_batch()
            times, robot = (
                batch.column(name).cast("int64").to_numpy(zero_copy_only=False) for name in (TIME, ROBOT_TIME)
            )
            for component in {SCALARS, TEXT, STATE, EVENT}.intersection(batch.schema.names):
                flat = batch.column(component).flatten().to_numpy(zero_copy_only=False)
                values = flat.reshape(len(times), -1) if component == SCALARS else flat
                yield chunk.entity_path, component, Column(times, robot, values)


@contextlib.contextmanager
def _opened(path: Path, *entities: str) -> Iterator[Iterable[Chunk]]:
    """Open the chunks of a recording, or those of some entities; raises the errors of `read` also while they are read."""
    check_recording(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RerunWarning)  # a killed recorder leaves a file without its end
            chunks = RrdReader(path).stream()
        yield chunks.filter(content=list(entities)) if entities else chunks
    except (ValueError, OSError, RuntimeError) as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"{path} is damaged ({str(error).splitlines()[0].rpartition(': ')[2]}): its recorder was killed, the disk was full, or "
            f"the file was copied only in part. `{typed('beatrix', 'record', '--repair', path)}` keeps all readable data.",
        ) from error


def _samples(columns: Columns, root: str) -> Samples:
    """Return the complete samples of one robot; incomplete ones are left out.

    In files of earlier versions, a node without new telemetry makes two samples of the same time stamp.
    """
    arms, commanded, head = (columns[f"{root}/{what}", SCALARS] for what in ("arms", "commanded", "head"))
    values = [_at(column, arms) for column in (commanded, head)]
    whole = ~np.isnan(np.hstack(values)).any(axis=1)
    measured, velocity, numbers, repeats = (
        columns.get((f"{root}/{what}", SCALARS)) for what in ("head_measured", "velocity", "seq", "repeats")
    )
    return Samples(
        arms.time_ns[whole],
        arms.robot_ns[whole],
        arms.values[whole].astype(np.float64),
        values[0][whole],
        values[1][whole],
        None if measured is None else _at(measured, arms)[whole],
        np.full_like(values[0], np.nan)[whole] if velocity is None else _at(velocity, arms)[whole],
        None if numbers is None else np.nan_to_num(_at(numbers, arms)[whole, 0], nan=-1).astype(np.int64),
        None if repeats is None else np.nan_to_num(_at(repeats, arms)[whole, 0]).astype(np.int64),
    )


def _at(column: Column, other: Column) -> Floats:
    """Return the column's values at the times of another column; NaN where it has no row of the same times."""
    rows = {
        stamp: row
        for row, stamp in enumerate(zip(column.time_ns.tolist(), column.robot_ns.tolist(), strict=True))
    }
    stamps = zip(other.time_ns.tolist(), other.robot_ns.tolist(), strict=True)
    found = np.array([rows.get(stamp, -1) for stamp in stamps], dtype=np.int64)
    values = column.values.astype(np.float64)[found]
    values[found < 0] = np.nan
    return values


def _difference(columns: Columns, name: str) -> tuple[Nanoseconds, Floats] | None:
    arms, head = (columns.get((f"/{name}/difference/{what}", SCALARS)) for what in ("arms", "head"))
    if arms is None or head is None:
        return None
    return arms.time_ns, np.hstack((arms.values.astype(np.float64), _at(head, arms)))


def _texts(columns: Columns, entity: str, component: str) -> TimedTexts:
    column = columns.get((entity, component))
    if column is None:
        none = np.empty(0, np.int64)
        return TimedTexts(none, none, ())
    return TimedTexts(column.time_ns, column.robot_ns, tuple(str(text) for text in column.values))


def _events(columns: Columns, entity: str) -> tuple[TimedEvent, ...]:
    column = columns.get((entity, EVENT))
    if column is None:
        return ()
    return tuple(
        TimedEvent(time_ns, decode_json(str(text).encode(), Event))
        for time_ns, text in zip(column.time_ns.tolist(), column.values, strict=True)
        if text
    )


def _clocks(columns: Columns, entity: str) -> tuple[ClockOffset, ...]:
    column = columns.get((entity, SCALARS))
    if column is None:
        return ()
    rows = zip(column.time_ns.tolist(), column.values.tolist(), strict=True)
    return tuple(ClockOffset(time_ns, *values) for time_ns, values in rows)


def _notes(columns: Columns) -> tuple[Note, ...]:
    column = columns.get((f"/{NOTES}", EVENT))
    return () if column is None else tuple(decode_json(str(text).encode(), Note) for text in column.values)


def _about(columns: Columns) -> About | None:
    column = columns.get((ABOUT_ENTITY, ABOUT))
    return None if column is None else _latest(column)


def _latest(column: Column) -> About:
    return decode_json(str(column.values[-1]).encode(), About)


def _static(chunk: Chunk) -> Column:
    """Return the versions of `About` in a static chunk in the order in which they were written: Rerun keeps the last."""
    batch = chunk.to_record_batch()
    numbers = batch.column("rerun.controls.RowId").to_pylist()
    times = np.array([int.from_bytes(number[:8], "big") for number in numbers], np.int64)
    return Column(times, times, batch.column(ABOUT).flatten().to_numpy(zero_copy_only=False))


def _parts(entity: str) -> tuple[str, str, str]:
    """Return name, side and the rest of an entity's path."""
    name, _, rest = entity.strip("/").partition("/")
    side, _, what = rest.partition("/")
    return name, side, what


BLOB = "EncodedImage:blob"


def read_eyes(paths: Sequence[Path], places: Sequence[Place], first_ns: int, last_ns: int) -> EyePictures:
    """Return the pictures of all eyes of these robots between two times, in the order of time.

    The files must be readable, which `read` checks.
    """
    entities = {"/" + of_robot(place, "camera", eye): (*place, eye) for place in places for eye in EYES}
    found: EyePictures = {}
    for path in paths:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RerunWarning)  # a killed recorder leaves a file without its end
            chunks = RrdReader(path).stream().filter(content=list(entities))
        for chunk in chunks:
            if chunk.is_static or TIME not in chunk.timeline_names:
                continue
            batch = chunk.to_record_batch()
            if BLOB not in batch.schema.names:
                continue
            times = batch.column(TIME).cast("int64").to_pylist()
            blobs = batch.column(BLOB).flatten()
            ends, flat = blobs.offsets.to_pylist(), blobs.values.to_numpy()
            found.setdefault(entities[chunk.entity_path], []).extend(
                EyePicture(time_ns, flat[begin:end].tobytes())
                for time_ns, (begin, end) in zip(times, itertools.pairwise(ends), strict=True)
                if first_ns <= time_ns <= last_ns
            )
    for pictures in found.values():
        pictures.sort(key=lambda picture: picture.time_ns)
    return {key: pictures for key, pictures in found.items() if pictures}


def read_sound(paths: Sequence[Path], places: Sequence[Place], first_ns: int, last_ns: int) -> SoundBlocks:
    """Return the blocks of sound of these robots between two times, in the order of time.

    The files must be readable, which `read` checks.
    """
    entities = {"/" + of_robot(place, "microphones"): place for place in places}
    found: SoundBlocks = {}
    if not entities:
        return found
    for path in paths:
        with _opened(path, *entities) as chunks:
            for chunk in chunks:
                if chunk.is_static or TIME not in chunk.timeline_names:
                    continue
                batch = chunk.to_record_batch()
                times = batch.column(TIME).cast("int64").to_pylist()
                parts = (batch.column(name).flatten().to_pylist() for name in ("pcm", "rate", "number"))
                found.setdefault(entities[chunk.entity_path], []).extend(
                    block
                    for block in itertools.starmap(RecordedBlock, zip(times, *parts, strict=True))
                    if first_ns <= block.time_ns <= last_ns
                )
    for blocks in found.values():
        blocks.sort(key=lambda block: block.time_ns)
    return {place: blocks for place, blocks in found.items() if blocks}
