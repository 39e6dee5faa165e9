"""The values of messages as all programs show them: from the table of the contract, without a list of names in a program."""

from __future__ import annotations

import math
import tomllib
from importlib import resources
from typing import Annotated

import msgspec
import numpy as np
import pytest
import simplejpeg
from hypothesis import given
from hypothesis import strategies as st
from statuses import AT_HOME, READY

from beatrix_zenoh.cli.streams import header, periodic, streams
from beatrix_zenoh.client.degrees import EYE_UP_M, bearing
from beatrix_zenoh.client.robot_base import RobotStatus
from beatrix_zenoh.client.subscription import CameraImage
from beatrix_zenoh.contract import values
from beatrix_zenoh.contract._generated import keys, messages
from beatrix_zenoh.contract._generated.messages import CameraStatus, Head, SeatCount, Status
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.contract.rows import ValueRow
from beatrix_zenoh.motion.rotation import rotation_of
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


class OneMore(Status, frozen=True, kw_only=True):
    """A status with one more field, as a contributor adds it."""

    sample_s: Annotated[float, ValueRow("sample", "s", "example")] = 2.5


def test_a_new_field_is_shown_by_every_program_without_being_named_there() -> None:
    status = OneMore(**msgspec.structs.asdict(READY))
    assert values.lines(status)["example"] == "sample 2.5 s"
    assert "example: sample 2,5 s" in details(status, Texts("de")).splitlines()
    assert values.as_data(status)["sample_s"] == 2.5


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
    kinds = [
        one for one in vars(messages).values() if isinstance(one, type) and issubclass(one, msgspec.Struct)
    ]
    rows = [row for kind in kinds for row in values.rows(kind).values()]
    known = {"not", "camera left", "camera right", *(word for row in rows for word in (row.title, row.group))}
    assert tomllib.loads(text)["values"].keys() - known == set()


def test_what_only_says_how_a_value_is_shown_changes_no_contract() -> None:
    import contract

    row = {"type": "bool", "doc": "it is pressed", "title": "pressed", "group": "touch", "decimals": 0}
    assert contract.bare({"touch": row}) == {"touch": {"type": "bool"}}
    assert contract.bare({"title": row}) == {"title": {"type": "bool"}}, "a field of this name"


# -- readings and pictures as a notebook shows them ------------------------------------------------


def picture(jpeg: bytes) -> CameraImage:
    return CameraImage(
        jpeg=jpeg, eye="left", seq=1, t_mono_ns=0, t_wall_ns=0, width=32, height=16, source="egl",
        arrived_mono_ns=0, arrived_wall_ns=0,
    )  # fmt: skip


def test_a_status_has_lines_without_clocks_and_empty_fields() -> None:
    fields = {**msgspec.structs.asdict(READY), "speed_limit": math.radians(20), "warnings": ["too hot"]}
    lines = repr(RobotStatus(**fields)).splitlines()
    assert lines[:3] == ["bea (hw)", "  enabled: True", "  calibrated: True"]
    assert {"  speed_limit: 20.0°/s", "  warnings: too hot", "  board.name: bea"} <= set(lines)
    assert not [line for line in lines if "t_mono_ns" in line or "waiting" in line]


def test_a_picture_shows_itself_and_gives_red_green_blue() -> None:
    red = np.zeros((16, 32, 3), np.uint8)
    red[..., 0] = 200
    image = picture(simplejpeg.encode_jpeg(red))
    assert image._repr_jpeg_() == image.jpeg
    assert len(repr(image)) < 80
    assert image.array().shape == (16, 32, 3)
    assert image.array()[8, 16] == pytest.approx((200, 0, 0), abs=4)
    with pytest.raises(WrongUsage, match="damaged"):
        picture(b"\xff\xd8nothing").array()


# -- the direction in which the eyes look at a place -----------------------------------------------


@given(x=st.floats(-2, 2), y=st.floats(-2, 2), z=st.floats(-0.6, 1.1))
def test_the_place_is_straight_ahead_of_the_eyes(x: float, y: float, z: float) -> None:
    if math.hypot(x, y) < 0.35:
        return
    yaw, pitch = bearing(x, y, z)
    rows = rotation_of(math.radians(yaw), math.radians(pitch), 0.0)
    ahead, left, up = (
        sum(row[i] * place for row, place in zip(rows, (x, y, z), strict=True)) for i in range(3)
    )
    assert ahead > 0
    assert (left, up) == pytest.approx((0.0, EYE_UP_M), abs=1e-9)


@pytest.mark.parametrize("place", [(0.05, 0.0, 0.1), (0.0, 0.0, 1.0)])
def test_a_place_in_or_above_the_head_is_rejected(place: tuple[float, float, float]) -> None:
    with pytest.raises(WrongUsage, match="choose one further away"):
        bearing(*place)
