"""The program that follows a face: where it finds the person in a picture, and how fast it turns the head."""

from __future__ import annotations

import runpy
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import simplejpeg
from hypothesis import given
from hypothesis import strategies as st

ROOT = Path(__file__).resolve().parents[2] / "beatrix_zenoh"
PICTURES = ROOT / "lessons/library/09-follow-the-face/files"
BEARINGS = tomllib.loads((PICTURES / "bearings.toml").read_text(encoding="utf-8"))


@cache
def program() -> dict[str, Any]:
    """Return the names of the program, which starts nothing when it is imported."""
    return runpy.run_path(str(ROOT / "examples/follow_the_face.py"))


@pytest.mark.parametrize("name", BEARINGS)
def test_the_cap_is_found_where_the_person_is(name: str) -> None:
    picture = simplejpeg.decode_jpeg((PICTURES / f"{name}.jpg").read_bytes())
    seen = program()["find_person"](picture)
    if BEARINGS[name] == "nobody":
        assert seen is None
    else:
        assert seen is not None
        assert seen[0] == pytest.approx(BEARINGS[name], abs=2.0)


@given(missing=st.floats(-180, 180), dt=st.floats(0, 0.2))
def test_a_step_goes_towards_the_person_and_never_beyond_nor_too_fast(missing: float, dt: float) -> None:
    taken = program()["step"](missing, dt)
    assert taken * missing >= 0
    assert abs(taken) <= min(abs(missing), program()["FASTEST"] * dt) + 1e-9
