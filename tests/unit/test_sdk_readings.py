"""Readings and pictures as a notebook shows them."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
import simplejpeg
from statuses import READY

from beatrix_zenoh.client.robot_base import RobotStatus
from beatrix_zenoh.client.subscription import CameraImage
from beatrix_zenoh.contract.errors import WrongUsage


def picture(jpeg: bytes) -> CameraImage:
    return CameraImage(jpeg, "left", 1, 0, 0, 32, 16, "egl", 0, 0)


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
