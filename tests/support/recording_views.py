"""The views of a recording: its tabs as the file's blueprint arranges them, and the entities that each view draws."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import UUID

from rerun.chunk import RrdReader, StoreEntry

KINDS = {1: "tabs", 2: "horizontal", 3: "vertical", 4: "grid"}
DRAWS = {
    "3D": {"Mesh3D"},
    "2D": {"EncodedImage"},
    "TimeSeries": {"Scalars"},
    "TextLog": {"TextLog"},
    "StateTimeline": {"StateChange"},
}
"""Archetypes that each kind of view draws."""

Table = dict[str, dict[str, Any]]
"""The last value of each component, by entity."""


@dataclass(frozen=True)
class View:
    """A view, and the entities of the recording that it draws."""

    kind: str
    title: str
    draws: frozenset[str]
    settings: Table
    """what the blueprint sets for this view, by archetype"""
    hidden: frozenset[str] = frozenset()
    """entities that are not drawn until the user switches them on"""


@dataclass(frozen=True)
class Box:
    """A container: tabs, horizontal, vertical or grid."""

    kind: str
    title: str
    parts: tuple[Box | View, ...]

    @property
    def views(self) -> list[View]:
        """All views inside, in order."""
        return [view for part in self.parts for view in ([part] if isinstance(part, View) else part.views)]


def tabs_of(path: Path) -> dict[str, Box]:
    """Return the outermost tabs of a recording by their titles."""
    reader = RrdReader(path)
    store = max(reader.blueprints(), key=lambda one: written(reader, one))
    blueprint, drawable = table(reader.stream(store=store)), archetypes(path)
    root = part(
        blueprint,
        f"container/{UUID(bytes=bytes(blueprint['/viewport']['ViewportBlueprint:root_container'][0]))}",
        drawable,
    )
    assert isinstance(root, Box)
    assert root.kind == "tabs"
    return {one.title: one for one in root.parts if isinstance(one, Box)}


def written(reader: RrdReader, store: StoreEntry) -> bytes:
    """Return the newest row number of a blueprint, which begins with the time of writing.

    A recorder writes a blueprint whenever a robot appears, and the viewer shows the newest.
    """
    rows = [chunk.to_record_batch().column("rerun.controls.RowId") for chunk in reader.stream(store=store)]
    return bytes(max(number for row in rows for number in row.to_pylist()))


def table(chunks: Any) -> Table:
    """Return the last value of each component, by entity."""
    found: Table = {}
    for chunk in chunks:
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if ":" in name and len(batch):
                found.setdefault(str(chunk.entity_path), {})[name] = batch.column(name).to_pylist()[-1]
    return found


def archetypes(path: Path) -> dict[str, set[str]]:
    """Return the archetypes of each entity that has data in the recording."""
    return {
        entity: {name.partition(":")[0] for name in values}
        for entity, values in table(RrdReader(path).stream()).items()
    }


def part(blueprint: Table, name: str, drawable: dict[str, set[str]]) -> Box | View:
    """Return a container or view of the blueprint."""
    own = blueprint[f"/{name}"]
    if name.startswith("container/"):
        return Box(
            KINDS[own["ContainerBlueprint:container_kind"][0]],
            own.get("ContainerBlueprint:display_name", [""])[0],
            tuple(part(blueprint, inner, drawable) for inner in own["ContainerBlueprint:contents"]),
        )
    kind = own["ViewBlueprint:class_identifier"][0]
    origin = own["ViewBlueprint:space_origin"][0].rstrip("/")
    rules = blueprint[f"/{name}/ViewContents"]["ViewContents:query"]
    wanted = [rule.removeprefix("+ ").replace("$origin", origin) for rule in rules]
    draws = {
        entity
        for entity, kinds in drawable.items()
        if kinds & DRAWS[kind] and any(matches(entity, rule) for rule in wanted)
    }
    settings = {
        key.rpartition("/")[2]: values for key, values in blueprint.items() if key.startswith(f"/{name}/")
    }
    overrides = f"/{name}/ViewContents/overrides"
    hidden = {
        key.removeprefix(overrides).removesuffix("/visualizers")
        for key, values in blueprint.items()
        if key.startswith(overrides) and values.get("EntityBehavior:visible") == [False]
    }
    return View(kind, own["ViewBlueprint:display_name"][0], frozenset(draws), settings, frozenset(hidden))


def matches(entity: str, rule: str) -> bool:
    """Return whether a rule of a view's contents includes an entity; `/**` at its end includes the whole subtree."""
    root, below, _ = rule.partition("/**")
    return entity == root or bool(below and entity.startswith(root + "/"))


def solids(place: tuple[str, str], variant: str, entities: frozenset[str]) -> Iterator[str]:
    """Yield the bodies of a robot's model that are drawn in a variant, `solid` or `ghost`."""
    start = f"/{place[0]}/{place[1]}/model/"
    for entity in entities:
        if entity.startswith(start) and entity.endswith(f"/{variant}"):
            yield entity.removeprefix(start).removesuffix(f"/{variant}")
