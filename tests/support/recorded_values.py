"""Values in a recording that BEATRIX writes for the viewer and does not read, by Rerun's own reader."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rerun.chunk import RrdReader

if TYPE_CHECKING:
    from pathlib import Path

STATE, TEXT, SCALARS = "StateChange:state", "TextLog:text", "Scalars:scalars"


def recorded_values(path: Path, entity: str, component: str) -> list[Any]:
    """Return the values of a component of an entity, in the order of time."""
    reader = RrdReader(path)
    found: list[tuple[int, list[Any]]] = []
    for store in reader.recordings():
        for chunk in reader.stream(store=store).filter(content=[f"/{entity}"]):
            batch = chunk.to_record_batch()
            if component in batch.schema.names:
                times = batch.column("time").cast("int64").to_pylist()
                found += zip(times, batch.column(component).to_pylist(), strict=True)
    return [value for _, values in sorted(found, key=lambda row: row[0]) for value in values]
