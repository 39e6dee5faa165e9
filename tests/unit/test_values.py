"""The values of messages as all programs show them: from the table of the contract, without a list of names in a program."""

from __future__ import annotations

import math
import tomllib
from importlib import resources

import msgspec
import pytest
from statuses import AT_HOME, READY

from beatrix_zenoh.cli.streams import header, periodic, streams
from beatrix_zenoh.contract import values
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import CameraStatus, Head, SeatCount, Status
from beatrix_zenoh.contract._generated.values import VALUES, ValueRow
from gui.console.state.pills import details
from gui.console.texts import Texts

CAMERA = CameraStatus(
    eye="left", connected=True, streaming=False, hz=29.5, width=640, height=480, source="egl"
)
BUSY = msgspec.structs.replace(
    READY, speed_limit=math.radians(20), cameras=[CAMERA], stops=[SeatCount(seat="ana", count=3)]
)


def test_a_status_is_in_groups_with_units_that_people_read() -> None:
    groups = values.grouped(BUSY)
    assert {"state", "lease", "stops", "board", "physics", "camera left", "microphones"} <= groups.keys()
    shown = {one.field: one.text() for one in values.values(BUSY)}
    assert shown["speed_limit"] == "20.0°/s"
    assert shown["cameras.left.hz"] == "29.5 1/s"
    assert (shown["enabled"], shown["moving"], shown["holder"]) == ("yes", "no", "-")
    assert values.lines(BUSY)["camera left"].startswith(
        "connected, not streaming, rate 29.5 1/s, width 640 px"
    )


def test_angles_of_a_vector_are_in_degrees_also_as_data() -> None:
    nodding = msgspec.structs.replace(AT_HOME, head=Head(0.0, math.radians(10), 0.0))
    assert {one.field: one.text() for one in values.values(nodding)}["head.pitch"] == "10.0°"
    assert values.as_data(nodding)["head"] == {"yaw_deg": 0.0, "pitch_deg": 10.0, "roll_deg": 0.0}
    assert values.as_data(BUSY)["speed_limit_deg_s"] == 20.0


def test_every_value_of_a_status_has_a_group() -> None:
    assert {one.field for one in values.values(BUSY) if not one.group} == set()


class Touch(Status, frozen=True, kw_only=True):
    """A status with one more field, as a contributor adds it."""

    pressed_s: float = 2.5


def test_a_new_field_is_shown_by_every_program_without_being_named_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    row = ValueRow("pressed", "s", "touch")
    tables: dict[type[msgspec.Struct], dict[str, ValueRow]] = {**VALUES}
    tables[Touch] = VALUES[Status] | {"pressed_s": row}
    monkeypatch.setattr(values, "VALUES", tables)
    status = Touch(**msgspec.structs.asdict(READY))
    assert values.lines(status)["touch"] == "pressed 2.5 s"
    assert "touch: pressed 2,5 s" in details(status, Texts("de")).splitlines()
    assert values.as_data(status)["pressed_s"] == 2.5


def test_a_new_row_of_keys_is_a_stream(monkeypatch: pytest.MonkeyPatch) -> None:
    measured = {"positions", "camera/left", "camera/right", "camera/outside", "microphones"}
    assert measured | {"status", "events"} <= streams().keys()
    assert measured <= {*periodic()}
    assert not {"status", "events", "positions/json"} & {*periodic()}
    new = keys.KEYS["positions"]._replace(key="beatrix/{robot}/{side}/state/new")
    monkeypatch.setitem(keys.KEYS, "new", new)
    assert "new" in streams()
    assert "new" in periodic()
    assert header(keys.KEYS["microphones"]).__name__ == "SoundHeader"


def test_german_names_are_those_of_values_and_groups() -> None:
    text = resources.files("gui.console.texts").joinpath("de.toml").read_text(encoding="utf-8")
    known = {row.title for kind in VALUES for row in values.rows(kind).values()} | {
        "not",
        "camera left",
        "camera right",
    }
    known |= {row.group for rows in VALUES.values() for row in rows.values()}
    assert tomllib.loads(text)["values"].keys() - known == set()


def test_what_only_says_how_a_value_is_shown_changes_no_contract() -> None:
    import contract

    row = {"type": "bool", "doc": "it is pressed", "title": "pressed", "group": "touch", "decimals": 0}
    assert contract.bare({"touch": row}) == {"touch": {"type": "bool"}}
    assert contract.bare({"title": row}) == {"title": {"type": "bool"}}, "a field of this name"
