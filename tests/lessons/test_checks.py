"""Checks of lessons with motions that the test draws: what passes and what does not, without a robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
import pytest

from beatrix_zenoh.contract._generated.messages import Event, EventKind, Phase, Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.lesson_files import find
from beatrix_zenoh.lessons import bench
from beatrix_zenoh.lessons.attempt import Attempt, Seen, Unmet
from beatrix_zenoh.lessons.checking import check_of
from beatrix_zenoh.lessons.guarded import LineChild, NoReply
from beatrix_zenoh.lessons.phrases import NotMeasurable

PERIOD_S, MOTION_S = 0.02, 0.4
NODS = [(0.0, pitch, 0.0) for pitch in (15, -5, 15, -5, 0)]
SHAKE = [25.0, -25.0]


def drawn(poses: Sequence[tuple[float, float, float]], *events: Event) -> Seen:
    """Return what a head shows that goes from pose to pose (yaw, pitch, roll; deg), beginning and ending at home."""
    corners = np.array([(0.0, 0.0, 0.0), *poses, (0.0, 0.0, 0.0)])
    t = np.arange(0.0, (len(corners) - 1) * MOTION_S + PERIOD_S / 2, PERIOD_S)
    at_s = np.arange(len(corners)) * MOTION_S
    head = np.column_stack([np.interp(t, at_s, corners[:, axis]) for axis in range(3)])
    none = np.zeros_like(head)
    return Seen(t, head, none, none, none, list(events), np.zeros(len(events)))


REFUSED = Event(
    seq=1,
    t_mono_ns=0,
    t_wall_ns=0,
    kind=EventKind.MOTION,
    seat="ana",  # Robot(who="ana")
    reason=Reason.YAW_LIMIT,
    phase=Phase.ACCEPTED,
)


class Drawn:
    """An attempt whose program has shown a drawn motion."""

    require = staticmethod(Attempt.require)

    def __init__(self, seen: Seen) -> None:
        self._seen = seen

    def observe(self) -> Seen:
        return self._seen


def figure(number: int, seen: Seen) -> str:
    """Return the figure of a lesson that is not met; empty: passed."""
    try:
        check_of(find(number))(cast("Attempt", Drawn(seen)))
    except Unmet as unmet:
        return unmet.figure
    return ""


@pytest.mark.parametrize(
    ("yaws", "unmet"),
    [
        (SHAKE * 2, ""),
        (SHAKE * 3, ""),
        ([-20.0, 19.93] * 2, ""),
        (SHAKE, "shakes"),
        ([*SHAKE, 25.0], "shakes"),
        ([15.0, -15.0] * 4, "shakes"),
        ([40.0, 0.0] * 4, "shakes"),
        ([25.0, 5.0, 25.0, -25.0, -5.0, -25.0], "shakes"),
    ],
)
def test_only_whole_shakes_to_both_sides_count(yaws: list[float], unmet: str) -> None:
    assert figure(1, drawn([*NODS, *((yaw, 0.0, 0.0) for yaw in yaws)], REFUSED)) == unmet
    assert figure(1, drawn([*NODS, *((yaw, 0.0, 0.0) for yaw in SHAKE * 2)])) == "refusal"


@pytest.mark.parametrize(
    ("code", "error", "words"),
    [(None, NotMeasurable, "too busy"), (1, Refused, "exit code 1"), (-9, Refused, "SIGKILL")],
)
def test_a_bench_without_an_answer_is_not_called_missing(
    code: int | None, error: type[Exception], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ask(*_arguments: object) -> None:
        raise NoReply(code)

    monkeypatch.setattr(LineChild, "ask", ask)
    with pytest.raises(error, match=words):
        bench.start(None)
