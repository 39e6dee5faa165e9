"""What the SDK takes for an angle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beatrix_zenoh import BeatrixError
from beatrix_zenoh.robot import to_rad


@pytest.mark.parametrize("angle", [90, 90.0, np.float32(90), np.float64(90), np.int64(90)])
def test_whatever_counts_is_taken(angle: float) -> None:
    assert to_rad("yaw", angle) == pytest.approx(math.pi / 2)


@pytest.mark.parametrize(
    ("angle", "told"),
    [
        ("20", "yaw is '20': give a number of degrees"),
        (None, "yaw is None: give a number of degrees"),
        ([1.0], "yaw is"),
        (math.nan, "yaw is nan: give a finite number of degrees"),
        (1e300, "no message holds a number that large"),
    ],
)
def test_whatever_does_not_is_refused_by_name(angle: float, told: str) -> None:
    with pytest.raises(BeatrixError, match=told):
        to_rad("yaw", angle)
