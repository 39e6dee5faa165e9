"""`beatrix export lesson.mcap`: every sample, event and note as JSON that Foxglove and PlotJuggler can show."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import jsonschema
import msgspec
import numpy as np
import pytest
from mcap.reader import make_reader
from written_recordings import BEGAN_NS, STEP_NS, write_lesson

from beatrix_zenoh.cli import app
from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Detail,
    Event,
    EventKind,
    Head,
    Limit,
    MotionQuery,
    Phase,
    Positions,
    Reason,
    Vector3,
)
from beatrix_zenoh.contract.codec import encode_json
from beatrix_zenoh.recording.mcap import schema_of
from beatrix_zenoh.recording.rows import NOTES, Line, Numbers, RecordingRow
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.samples import Note

PLACES = ("ada", "sim"), ("ada", "hw")
ROWS = 100
AT_NS = BEGAN_NS - STEP_NS
"""Before the first sample, because a program has connected before the recorder heard the robot."""
REFUSED = Event(
    seq=7,
    t_mono_ns=1,
    t_wall_ns=AT_NS - 5,
    kind=EventKind.MOTION,
    phase=Phase.ACCEPTED,
    reason=Reason.ARM_GAP,
    detail=Detail(limit=Limit.ARM_GAP, value=0.2, low=0.5, unit="rad", alternative=Alternative(head=Head(0.1, 0.0, 0.0))),
    motion_query=MotionQuery(position=Vector3(0.1, 0.2, 0.3)),
)  # fmt: skip
NOTE = Note(AT_NS, "ana", "trial 2")


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of both sides of one robot, of which the simulation has more values, with an event and a note."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.rrd"
    more: list[RecordingRow] = [
        Line("ada/hw/events", AT_NS, "refused", "WARN", encode_json(REFUSED).decode()),
        Line(NOTES, AT_NS, "a note", "INFO", encode_json(NOTE).decode()),
    ]
    for row in range(ROWS):
        at_ns = BEGAN_NS + row * STEP_NS
        more.append(Numbers("ada/sim/seq", at_ns, (float(row + 3),)))
        more.append(Numbers("ada/sim/head_measured", at_ns, (1.0, 2.0, -3.0)))
    write_lesson(path, PLACES, rows=ROWS, more=more)
    return path


def exported(lesson: Path, out: Path, *options: str) -> list[tuple[str, int, int, dict[str, object]]]:
    """Export, and return topic, both times and content of each message, each of which its schema accepts."""
    assert app.run(["export", str(lesson), str(out), *options]) == 0
    with out.open("rb") as file:
        found, rules = [], dict[int, jsonschema.Draft202012Validator]()
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages(
            log_time_order=False
        ):
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            if schema.id not in rules:
                jsonschema.Draft202012Validator.check_schema(json.loads(schema.data))
                rules[schema.id] = jsonschema.Draft202012Validator(closed(json.loads(schema.data)))
            content = json.loads(message.data)
            rules[schema.id].validate(content)
            found.append((channel.topic, message.log_time, message.publish_time, content))
    return found


def closed(rules: dict[str, object]) -> dict[str, object]:
    """Return a schema that accepts no other fields than those it names."""
    parts = {name: closed(part) if isinstance(part, dict) else part for name, part in rules.items()}
    return parts | ({"additionalProperties": False} if "properties" in rules else {})


def test_each_sample_is_a_message_with_its_times_and_angles(lesson: Path, tmp_path: Path) -> None:
    found = exported(lesson, tmp_path / "lesson.mcap")
    assert [at for _, at, _, _ in found] == sorted(at for _, at, _, _ in found)
    for name, side in PLACES:
        samples = read(lesson).robots[name, side]
        rows = [row for row in found if row[0] == f"/beatrix/{name}/{side}/state/positions"]
        assert [at for _, at, _, _ in rows] == samples.time_ns.tolist()
        assert [at for _, _, at, _ in rows] == samples.robot_ns.tolist()
        for field, values in (("position", samples.arms), ("head", samples.head)):
            angles = [list(row[3][field].values()) for row in rows]  # type: ignore[attr-defined]
            np.testing.assert_allclose(angles, np.radians(values), atol=1e-7)
    of_sim = next(content for topic, _, _, content in found if "/sim/" in topic)
    assert list(of_sim) == ["seq", "t_wall_ns", "position", "commanded", "head", "head_measured"]
    assert of_sim["seq"] == 3
    assert of_sim["head_measured"] == pytest.approx(
        {"yaw": math.radians(1), "pitch": math.radians(2), "roll": math.radians(-3)}, abs=1e-7
    )


def test_events_and_notes_are_messages_without_nulls(lesson: Path, tmp_path: Path) -> None:
    (event,) = (row for row in exported(lesson, tmp_path / "all.mcap") if row[0].endswith("events"))
    assert event[:3] == ("/beatrix/ada/hw/state/events", AT_NS, AT_NS - 5)
    assert msgspec.convert(event[3], Event) == REFUSED
    assert b"null" not in json.dumps(event[3]).encode()
    (note,) = (row for row in exported(lesson, tmp_path / "again.mcap") if row[0] == "/notes")
    assert msgspec.convert(note[3], Note) == NOTE


def test_a_part_has_the_samples_between_its_ends(
    lesson: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "part.mcap"
    found = exported(lesson, out, "--from", "1", "--to", "1.5")
    assert len(found) == 2 * 26
    assert capsys.readouterr().out == f"{out}: 52 messages of ada (hw), ada (sim).\n"
    assert {at for _, at, _, _ in found} == {BEGAN_NS + k * STEP_NS for k in range(50, 76)}


@pytest.mark.parametrize("kind", [Positions, Event, Note])
def test_schemas_are_as_simple_as_the_parser_of_foxglove(kind: type[msgspec.Struct]) -> None:
    """That parser knows neither references nor choices, and needs the type of each field and of each item."""

    def parts(schema: dict[str, object]) -> Iterator[dict[str, object]]:
        yield schema
        inner = [*schema.get("properties", {}).values(), schema.get("items")]  # type: ignore[attr-defined]
        for part in filter(None, inner):
            yield from parts(part)

    for part in parts(json.loads(msgspec.json.encode(schema_of(kind)))):
        assert part["type"] in {"object", "array", "string", "number", "integer", "boolean"}
        assert part.keys() <= {"type", "description", "enum", "properties", "items"}
        assert (part["type"] == "object") == ("properties" in part)
        assert (part["type"] == "array") == ("items" in part)


def test_without_its_library_the_refusal_names_the_command(
    lesson: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delitem(sys.modules, "beatrix_zenoh.recording.mcap", raising=False)
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    assert app.run(["export", str(lesson), str(tmp_path / "lesson.mcap")]) == 1
    assert "Run `beatrix install mcap`." in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
