"""Read a recording."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, TypeVar

import msgspec
import numpy as np

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import Event, Reason
from beatrix_zenoh.contract.codec import decode_json
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.contract.names import EYES, SIDES
from beatrix_zenoh.recording.rows import NOTES, of_robot
from beatrix_zenoh.recording.rrd.columns import (
    ABOUT,
    ABOUT_ENTITY,
    BLOB,
    EVENT,
    NUMBER,
    PCM,
    RATE,
    SCALARS,
    TIME,
    Column,
    Columns,
    Components,
    foreign,
    joined,
    rows,
)
from beatrix_zenoh.recording.samples import (
    About,
    EyePicture,
    EyePictures,
    Floats,
    Note,
    Recorded,
    Samples,
    Span,
    TimedEvent,
    check_parts,
    union,
)
from beatrix_zenoh.recording.sound import RecordedBlock

ANGLES: Final[Components] = {SCALARS: 3}
OF_ROBOT: Final[Mapping[str, Components]] = {
    **dict.fromkeys(("arms", "commanded", "head", "head_measured", "velocity"), ANGLES),
    "seq": {SCALARS: 1},
    "repeats": {SCALARS: 1},
    "events": {EVENT: 1},
}
"""Components of the entities of a robot."""
NONE: Final[Components] = {}
SOUND: Final = (PCM, RATE, NUMBER)
RATE_MAX: Final = 384_000
"""Frames per second; no sound card is faster."""
SoundBlocks = dict[Place, list[RecordedBlock]]
M = TypeVar("M", bound=msgspec.Struct)


def read(path: Path) -> Recorded:
    """Read a recording, even if its recorder was killed, or Rerun's own program has split, filtered or merged it.

    Raises:
        WrongUsage: there is no such file.
        Refused: BAD_VALUE, the file is damaged or not one recording of BEATRIX.
    """
    columns = _columns(path)
    robots: dict[Place, Samples] = {}
    for name, side, what in [_parts(entity) for entity, _ in columns]:
        root = f"/{name}/{side}"
        # A recorder that was killed just after its start may have written only some of these columns.
        complete = all((f"{root}/{other}", SCALARS) in columns for other in ("commanded", "head"))
        if side in SIDES and what == "arms" and complete:
            samples = _samples(columns, root)
            if len(samples.time_ns):
                robots[name, side] = samples
    if not robots:
        raise Refused(
            Reason.BAD_VALUE,
            f"{path} contains no positions of a robot on the timeline `{TIME}`. `beatrix record` writes recordings; if "
            "another program has changed one, use the original file.",
        )
    return Recorded(
        dict(sorted(robots.items())),
        {place: _events(path, columns, "/{}/{}/events".format(*place)) for place in robots},
        tuple(note for _, note in _decoded(path, columns, f"/{NOTES}", EVENT, Note)),
        _about(path, columns),
    )


def read_about(path: Path) -> About | None:
    """Return what a recording says of itself, without reading its data; raises the errors of `read`."""
    parts = rows(path, _components, [ABOUT_ENTITY])
    return _about(path, joined((key, column) for _, key, column in parts))


def holds_samples(path: Path) -> bool:
    """Return whether a recording contains positions of any robot; False if it cannot be read."""
    try:
        return bool(read(path).robots)
    except Refused:
        return False


def _components(entity: str) -> Components:
    """Return the components of an entity that `read` reads."""
    _, side, what = _parts(entity)
    if entity == ABOUT_ENTITY:
        return {ABOUT: 1}
    if entity == f"/{NOTES}":
        return {EVENT: 1}
    return OF_ROBOT.get(what, NONE) if side in SIDES else NONE


def _columns(path: Path) -> Columns:
    """Return all columns of a file; raises the errors of `read`."""
    found = []
    spans: dict[int, dict[Place, Span]] = defaultdict(dict)
    for number, key, column in rows(path, _components):
        found.append((key, column))
        name, side, what = _parts(key[0])
        if side in SIDES and what == "arms":
            span = int(column.time_ns.min()), int(column.time_ns.max())
            spans[number][name, side] = union([span, spans[number].get((name, side), span)])
    check_parts(spans.values(), f"Two of the recordings in {path}", "Use the files that were merged into it.")
    return joined(found)


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
    """Return the column's values at the times of another column; NaN where it has no row of the same time."""
    found = np.searchsorted(column.time_ns, other.time_ns, side="right") - 1
    values = column.values.astype(np.float64)[found]
    values[column.time_ns[found] != other.time_ns] = np.nan
    return values


def _events(path: Path, columns: Columns, entity: str) -> tuple[TimedEvent, ...]:
    return tuple(TimedEvent(*row) for row in _decoded(path, columns, entity, EVENT, Event))


def _about(path: Path, columns: Columns) -> About | None:
    """Return the newest description: Rerun keeps the last."""
    found = _decoded(path, columns, ABOUT_ENTITY, ABOUT, About)
    return found[-1][1] if found else None


def _decoded(path: Path, columns: Columns, entity: str, component: str, kind: type[M]) -> list[tuple[int, M]]:
    """Return times and values of a column of JSON texts; raises Refused if one cannot be read."""
    column = columns.get((entity, component))
    if column is None:
        return []
    try:
        return [
            (time_ns, decode_json(text.encode(), kind))
            for time_ns, text in zip(column.time_ns.tolist(), column.values[:, 0], strict=True)
            if text
        ]
    except BeatrixError as error:
        raise foreign(path, entity) from error


def _parts(entity: str) -> tuple[str, str, str]:
    """Return name, side and the rest of an entity's path."""
    name, _, rest = entity.strip("/").partition("/")
    side, _, what = rest.partition("/")
    return name, side, what


def read_eyes(paths: Sequence[Path], places: Sequence[Place], first_ns: int, last_ns: int) -> EyePictures:
    """Return the pictures of all eyes of these robots between two times, in the order of time; raises the errors of `read`."""
    entities = {"/" + of_robot(place, "camera", eye): (*place, eye) for place in places for eye in EYES}
    columns = _of_entities(paths, list(entities), [BLOB], first_ns, last_ns)
    return {
        entities[entity]: [
            EyePicture(*row) for row in zip(column.time_ns.tolist(), column.values[:, 0], strict=True)
        ]
        for (entity, _), column in columns.items()
    }


def read_sound(paths: Sequence[Path], places: Sequence[Place], first_ns: int, last_ns: int) -> SoundBlocks:
    """Return the blocks of sound of these robots between two times, in the order of time; raises the errors of `read`."""
    entities = {"/" + of_robot(place, "microphones"): place for place in places}
    columns = _of_entities(paths, list(entities), SOUND, first_ns, last_ns)
    found: SoundBlocks = {}
    for entity, place in entities.items():
        blocks, rates, numbers = (
            dict(zip(column.time_ns.tolist(), column.values[:, 0], strict=True))
            if (column := columns.get((entity, component)))
            else {}
            for component in SOUND
        )
        for at in sorted(blocks.keys() & rates.keys() & numbers.keys()):
            if not 0 < rates[at] <= RATE_MAX:
                raise foreign(paths[0], entity)
            found.setdefault(place, []).append(
                RecordedBlock(at, blocks[at], int(rates[at]), int(numbers[at]))
            )
    return found


def _of_entities(
    paths: Sequence[Path], entities: Sequence[str], components: Sequence[str], first_ns: int, last_ns: int
) -> Columns:
    """Return columns of some entities between two times, from the files of one recording."""
    if not entities:
        return {}
    wanted = dict.fromkeys(components, 1)
    return joined(
        (key, column)
        for path in paths
        for _, key, column in rows(path, lambda _entity: wanted, entities, (first_ns, last_ns))
    )
