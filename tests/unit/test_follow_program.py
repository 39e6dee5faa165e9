"""The program that follows a face: where it finds the person in a picture, and how fast it turns the head."""

from __future__ import annotations

import importlib.util
import tomllib
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import simplejpeg
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.client.degrees import HeadAngles

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


def test_a_place_above_the_middle_is_up() -> None:
    picture = np.zeros((120, 160, 3), dtype=np.uint8)
    picture[20:30, 100:110] = (200, 0, 120)
    left, down = program().find_person(picture)
    assert left < 0
    assert down < 0


@given(missing=st.floats(-180, 180), dt=st.floats(0, 0.2))
def test_a_step_goes_towards_the_person_and_never_beyond_nor_too_fast(missing: float, dt: float) -> None:
    taken = program().step(missing, dt)
    assert taken * missing >= 0
    assert abs(taken) <= min(abs(missing), program().FASTEST * dt) + 1e-9


class Still:
    """A robot whose eye sees the person at the same place in each of 100 pictures, at 15 pictures a second."""

    def __init__(self) -> None:
        self.looks: list[tuple[float, float]] = []

    def stream(self) -> AbstractContextManager[SimpleNamespace]:
        reading = SimpleNamespace(t=0.0, head=HeadAngles(0.0, 0.0, 0.0))
        return nullcontext(SimpleNamespace(next=lambda: reading, take=list))

    def camera(self, _eye: str, timeout_s: float) -> AbstractContextManager[list[SimpleNamespace]]:
        assert timeout_s
        pictures = [
            SimpleNamespace(t_mono_ns=number * 66_000_000, array=lambda: None) for number in range(100)
        ]
        return nullcontext(pictures)

    def look(self, *, yaw: float, pitch: float, wait: bool) -> None:
        assert not wait
        self.looks.append((yaw, pitch))


@pytest.mark.parametrize(("left", "down", "looks"), [(0.4, -0.4, 0), (20.0, 5.0, 40)])
def test_a_robot_that_need_not_turn_gets_no_request(
    monkeypatch: pytest.MonkeyPatch, left: float, down: float, looks: int
) -> None:
    monkeypatch.setattr(program(), "find_person", lambda _: (left, down))
    robots = [Still(), Still()]
    program().follow(robots)
    assert robots[0].looks == robots[1].looks
    assert len(robots[0].looks) <= looks
    if looks:
        assert robots[0].looks[-1] == pytest.approx((left, down), abs=program().LEAST)
