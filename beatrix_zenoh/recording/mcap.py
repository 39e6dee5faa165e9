"""A recording as MCAP, for Foxglove and PlotJuggler: JSON with JSON Schema.

Topics are the keys that robots publish on, after a slash, without which Foxglove wants quotes. Fields are those of the
messages of the contract, so that angles are in rad.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np
from mcap.writer import Writer

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Head, Positions, Vector3
from beatrix_zenoh.contract.codec import encode_json
from beatrix_zenoh.recording.export import Table
from beatrix_zenoh.recording.samples import Floats, Note, Samples, TimedEvent

NOTES: Final = "/notes"
"""Topic of the notes of users."""
ANGLES: Final = {
    "position": ("arms", Vector3),
    "velocity": ("velocity", Vector3),
    "commanded": ("commanded", Vector3),
    "head": ("head", Head),
    "head_measured": ("head_measured", Head),
}
"""Fields of Positions, each with its field of `Samples`, and its message."""
NOT_RECORDED: Final = ("t_mono_ns", "steps", "repeated")
DECIMALS: Final = 7
"""Decimals of angles (rad): those of a float32 near 1, and short as text."""


class Schema(msgspec.Struct, omit_defaults=True, rename={"ref": "$ref", "choices": "anyOf"}):
    """The parts of JSON Schema that describe the type of a field."""

    type: str = ""
    description: str = ""
    enum: list[str] = []
    properties: dict[str, Schema] = {}
    items: Schema | None = None
    ref: str = ""
    choices: list[Schema] = []


class Message(NamedTuple):
    """A message of a channel: `time_ns` by the clock of the recording computer, `robot_ns` by that of the robot."""

    time_ns: int
    robot_ns: int
    topic: str
    kind: type[msgspec.Struct]
    json: bytes
    seq: int = 0


def write_mcap(path: Path, table: Table) -> int:
    """Write the samples, events and notes of a table in the order of time, and return their number; raises OSError."""
    parts = [samples_of(place, samples, table) for place, samples in table.robots.items()]
    parts += [events_of(place, events) for place, events in table.events.items()]
    merged = heapq.merge(*parts, notes_of(table.notes), key=lambda message: message.time_ns)
    number, channels = 0, dict[str, int]()
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="beatrix")
        for number, message in enumerate(merged, start=1):  # noqa: B007
            topic, kind = message.topic, message.kind
            if topic not in channels:
                schema = msgspec.json.encode(schema_of(kind))
                numbered = writer.register_schema(f"beatrix.{kind.__name__}", "jsonschema", schema)
                channels[topic] = writer.register_channel(topic, "json", numbered)
            times = message.time_ns, message.robot_ns if message.robot_ns > 0 else message.time_ns
            writer.add_message(channels[topic], times[0], message.json, times[1], message.seq)
        writer.finish()  # type: ignore[no-untyped-call]
    return number


def samples_of(place: Place, samples: Samples, table: Table) -> Iterator[Message]:
    """Yield the samples of one robot; a field that was not recorded is missing."""
    topic = f"/{keys.positions(*place)}"
    inside = (samples.time_ns >= table.first_ns) & (samples.time_ns <= table.last_ns)
    fields = {
        field: (kind.__struct_fields__, rounded(getattr(samples, held)[inside]))
        for field, (held, kind) in ANGLES.items()
    }
    stamps = (column[inside].tolist() for column in (samples.time_ns, samples.robot_ns, samples.seq))
    for row, (time_ns, robot_ns, seq) in enumerate(zip(*stamps, strict=True)):
        values: dict[str, object] = {"seq": seq, "t_wall_ns": robot_ns}
        values = {name: value for name, value in values.items() if value != -1}  # -1: not known
        for field, (axes, rows) in fields.items():
            if rows[row][0] == rows[row][0]:  # NaN: not recorded
                values[field] = dict(zip(axes, rows[row], strict=True))
        yield Message(time_ns, robot_ns, topic, Positions, msgspec.json.encode(values), max(0, seq))


def rounded(angles_deg: Floats) -> list[list[float]]:
    """Return rows of angles in rad; adding 0 turns -0.0 into 0."""
    rows: list[list[float]] = (np.radians(angles_deg).round(DECIMALS) + 0.0).tolist()
    return rows


def events_of(place: Place, events: tuple[TimedEvent, ...]) -> Iterator[Message]:
    """Yield the events of one robot, without fields that say nothing."""
    topic = f"/{keys.events(*place)}"
    for time_ns, event in ((one.time_ns, one.event) for one in events):
        json = msgspec.json.encode(filled(msgspec.json.decode(encode_json(event))))
        yield Message(time_ns, event.t_wall_ns, topic, Event, json, event.seq)


def notes_of(notes: tuple[Note, ...]) -> Iterator[Message]:
    """Yield notes."""
    for note in notes:
        yield Message(note.time_ns, note.time_ns, NOTES, Note, encode_json(note))


def filled(value: object) -> object:
    """Return a decoded message without its nulls: the viewers' schemas have one type for each field."""
    if isinstance(value, dict):
        return {name: filled(part) for name, part in value.items() if part is not None}
    return [filled(part) for part in value] if isinstance(value, list) else value


def schema_of(kind: type[msgspec.Struct]) -> Schema:
    """Return the JSON Schema of a message, with the fields that a recording has."""
    raw, parts = msgspec.json.schema_components([kind], ref_template="{name}")
    found = plain(msgspec.convert(raw[0], Schema), msgspec.convert(parts, dict[str, Schema]))
    if kind is Positions:
        found.properties = {name: one for name, one in found.properties.items() if name not in NOT_RECORDED}
    return found


def plain(schema: Schema, parts: Mapping[str, Schema]) -> Schema:
    """Return a schema as the viewers read it: without references and nulls, with one type for each field."""
    if schema.ref:
        schema = parts[schema.ref]
    if schema.choices:
        return plain(next(choice for choice in schema.choices if choice.type != "null"), parts)
    return msgspec.structs.replace(
        schema,
        type=schema.type or "string",  # of a word
        properties={name: plain(one, parts) for name, one in schema.properties.items()},
        items=schema.items and plain(schema.items, parts),
    )
