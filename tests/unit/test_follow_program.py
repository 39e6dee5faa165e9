"""The program that follows a face: where it finds the person in a picture, and how fast it turns the head."""

from __future__ import annotations

import importlib.util
import tomllib
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
import simplejpeg
from hypothesis import given
from hypothesis import strategies as st

ROOT = Path(__file__).resolve().parents[2] / "beatrix_zenoh"
PICTURES = ROOT / "lessons/library/09-follow-the-face/files"
BEARINGS = tomllib.loads((PICTURES / "bearings.toml").read_text(encoding="utf-8"))


@cache
def program() -> ModuleType:
    """Return the program as a module; it starts nothing when it is imported."""
    spec = importlib.util.spec_from_file_location("follow", ROOT / "examples/follow_the_face.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", BEARINGS)
def test_the_cap_is_found_where_the_person_is(name: str) -> None:
    picture = simplejpeg.decode_jpeg((PICTURES / f"{name}.jpg").read_bytes())
    seen = program().find_person(picture)
    if BEARINGS[name] == "nobody":
        assert seen is None
    else:
        assert seen is not None
        assert seen[0] == pytest.approx(BEARINGS[name], abs=2.0)


@given(missing=st.floats(-180, 180), dt=st.floats(0, 0.2))
def test_a_step_goes_towards_the_person_and_never_beyond_nor_too_fast(missing: float, dt: float) -> None:
    taken = program().step(missing, dt)
    assert taken * missing >= 0
    assert abs(taken) <= min(abs(missing), program().FASTEST * dt) + 1e-9
