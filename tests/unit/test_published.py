"""The helper that waits for a regular status gives up on a robot whose status never rests, and names the field."""

from __future__ import annotations

from itertools import count
from types import SimpleNamespace
from typing import cast

import msgspec
import published
import pytest
from statuses import READY

from beatrix_zenoh.contract._generated.messages import Status


def test_a_field_that_never_rests_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    changing = (msgspec.structs.replace(READY, calibrations=number) for number in count(2))
    robot = SimpleNamespace(client=None, place=("bea", "hw"), name="bea", side="hw", timeout_s=1.0)
    statuses = cast("published.Published[Status]", SimpleNamespace(robot=robot, next=changing.__next__))
    monkeypatch.setattr(published, "ask", lambda *_: READY)
    monkeypatch.setattr(published, "EVENT_S", 0.05)
    with pytest.raises(AssertionError, match="last changed: calibrations"):
        published.regular(statuses)
