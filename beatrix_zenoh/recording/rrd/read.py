"""Read a recording."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final, TypeVar

import msgspec
import numpy as np

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import Event
from beatrix_zenoh.contract.codec import decode_json
from beatrix_zenoh.contract.errors import BeatrixError, bad_value
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
    Nanoseconds,
    Note,
    Recorded,
    Samples,
    TimedEvent,
)
from beatrix_zenoh.recording.sound import RecordedBlock

WIDTHS: Final = {"commanded": 3, "head": 3, "head_measured": 3, "velocity": 3, "seq": 1, "repeats": 1}
"""Numbers in a row of the entities of a robot, beside its arms."""
OF_ROBOT: Final[Mapping[str, Components]] = {
    **{what: {SCALARS: width} for what, width in {"arms": 3, **WIDTHS}.items()},
    "events": {EVENT: 1},
}
"""Components of the entities of a robot."""
OTHERS: Final[Mapping[str, Components]] = {ABOUT_ENTITY: {ABOUT: 1}, f"/{NOTES}": {EVENT: 1}}
SOUND: Final = (PCM, RATE, NUMBER)
SoundBlocks = dict[Place, list[RecordedBlock]]
Span = tuple[int, int]
"""First and last time (ns since 1970)."""
M = TypeVar("M", bound=msgspec.Struct)


def read(*paths: Path) -> Recorded:
    """Read a recording, even if its recorder was killed, or Rerun's own program has split, filtered or merged it.

    Several paths are the files of one recording (`beatrix record --rotate`), in any order.

    Raises:
        WrongUsage: there is no such file.
        Refused: BAD_VALUE, a file is damaged, or the files are not one recording of BEATRIX.
    """
    files = ", ".join(map(str, paths))
    columns = _columns(paths)
    robots: dict[Place, Samples] = {}
    for name, side, what in [_parts(entity) for entity, _ in columns]:
        if side in SIDES and what == "arms":
            samples = _samples(columns, f"/{name}/{side}")
            if len(samples.time_ns):
                robots[name, side] = samples
    if not robots:
        raise bad_value(
            f"{files} contains no positions of a robot on the timeline `{TIME}`. `beatrix record` writes recordings; if "
            "another program has changed one, use the original file.",
        )
    return Recorded(
        dict(sorted(robots.items())),
        {place: _events(files, columns, "/{}/{}/events".format(*place)) for place in robots},
        tuple(note for _, note in _decoded(files, columns, f"/{NOTES}", EVENT, Note)),
        _about(files, columns),
    )


def read_about(path: Path) -> About | None:
    """Return what a recording says of itself, without reading its data; raises the errors of `read`."""
    parts = rows(path, _components, [ABOUT_ENTITY])
    return _about(str(path), joined((key, column) for _, key, column in parts))


def _components(entity: str) -> Components:
    """Return the components of an entity that `read` reads."""
    _, side, what = _parts(entity)
    return OTHERS.get(entity) or (OF_ROBOT.get(what, {}) if side in SIDES else {})


def _columns(paths: Sequence[Path]) -> Columns:
    """Return all columns of the files of one recording; raises the errors of `read`."""
    found = []
    parts: dict[tuple[int, int], dict[Place, Span]] = defaultdict(dict)
    for file, path in enumerate(paths):
        for number, key, column in rows(path, _components):
            found.append((key, column))
            name, side, what = _parts(key[0])
            if side in SIDES and what == "arms":
                part = parts[file, number]
                span = int(column.time_ns.min()), int(column.time_ns.max())
                part[name, side] = _union([span, part.get((name, side), span)])
    _check_parts(parts.values(), ", ".join(map(str, paths)))
    return joined(found)


APART_NS: Final = 3_600_000_000_000
"""Parts further apart than this are not of one recording: a table would have 180 000 empty rows for each hour."""
OVERLAP_NS: Final = 1_000_000_000
"""Parts of one recording may overlap by samples that arrived late; more than this is another recording."""


def _check_parts(parts: Iterable[Mapping[Place, Span]], files: str) -> None:
    """Raise Refused if two parts contain the same time of a robot, or are far apart: they are not of one recording."""
    ends: dict[Place, int] = {}
    for part in sorted(parts, key=lambda part: _union(part.values())):
        first_ns, _ = _union(part.values())
        apart_ns = first_ns - max(ends.values(), default=first_ns)
        shared = [place for place, span in part.items() if ends.get(place, 0) - span[0] > OVERLAP_NS]
        if shared or apart_ns > APART_NS:
            how = (
                "contain the same time of {} ({})".format(*shared[0])
                if shared
                else f"are {apart_ns / 3.6e12:.1f} h apart"
            )
            raise bad_value(
                f"{files}: two of the recordings there {how}, so they are not parts of one recording (`beatrix record --rotate`). "
                "Read them one by one; of a merged file, use the files that were merged.",
            )
        ends |= {place: max(ends.get(place, 0), last_ns) for place, (_, last_ns) in part.items()}


def _union(spans: Iterable[Span]) -> Span:
    """Return the span that contains these."""
    firsts, lasts = zip(*spans, strict=True)
    return min(firsts), max(lasts)


def _samples(columns: Columns, root: str) -> Samples:
    """Return the complete samples of one robot: a killed recorder may have written some of its columns only."""
    arms = columns[f"{root}/arms", SCALARS]
    found = {
        what: _at(columns.get((f"{root}/{what}", SCALARS)), arms.time_ns, width)
        for what, width in WIDTHS.items()
    }
    whole = ~np.isnan(np.hstack([found["commanded"], found["head"]])).any(axis=1)
    commanded, head, measured, velocity, seq, repeats = (values[whole] for values in found.values())
    return Samples(
        arms.time_ns[whole],
        arms.robot_ns[whole],
        arms.values[whole].astype(np.float64),
        commanded,
        head,
        measured,
        velocity,
        np.nan_to_num(seq[:, 0], nan=-1).astype(np.int64),
        np.nan_to_num(repeats[:, 0]).astype(np.int64),
    )


def _at(column: Column | None, times_ns: Nanoseconds, width: int) -> Floats:
    """Return the values (n, width) of a column at other times; NaN where it has no row of the same time."""
    if column is None:
        return np.full((len(times_ns), width), np.nan)
    found = np.searchsorted(column.time_ns, times_ns, side="right") - 1
    values = column.values.astype(np.float64)[found]
    values[column.time_ns[found] != times_ns] = np.nan
    return values


def _events(files: str, columns: Columns, entity: str) -> tuple[TimedEvent, ...]:
    return tuple(TimedEvent(*row) for row in _decoded(files, columns, entity, EVENT, Event))


def _about(files: str, columns: Columns) -> About | None:
    """Return the newest description: Rerun keeps the last."""
    found = _decoded(files, columns, ABOUT_ENTITY, ABOUT, About)
    return found[-1][1] if found else None


def _decoded(files: str, columns: Columns, entity: str, component: str, kind: type[M]) -> list[tuple[int, M]]:
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
        raise foreign(files, entity) from error


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
