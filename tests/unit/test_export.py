"""Tables of recordings: points of the grid, gaps, spans, files of a rotated recording."""

from __future__ import annotations

import itertools
import math
from collections import deque
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from written_recordings import BEGAN_NS, STEP_NS

from beatrix_zenoh.recording import rows
from beatrix_zenoh.recording.export import Table, at, table
from beatrix_zenoh.recording.samples import Floats, Note, Recorded, Samples

SIM, HW = ("bea", "sim"), ("bea", "hw")
ANGLES = st.floats(-180, 180, allow_nan=False)
TIMES = st.lists(st.integers(0, 2_000_000_000), min_size=1, max_size=40, unique=True).map(sorted)


def samples(times_ns: list[int], arms: Floats | None = None) -> Samples:
    """Return samples at these times after BEGAN_NS."""
    n = len(times_ns)
    angles = np.zeros((n, 3)) if arms is None else arms
    times = BEGAN_NS + np.array(times_ns, np.int64)
    unknown, velocity, none = np.full((n, 3), np.nan), np.full((n, 3), 4.0), np.zeros(n, np.int64)
    return Samples(times, times - 7, angles, angles + 1, angles + 2, unknown, velocity, np.arange(n), none)


def grid(found: Table) -> dict[str, Floats]:
    """Return all blocks of a grid as one."""
    blocks = list(found.grid())
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


@given(TIMES, st.data())
def test_values_between_samples_lie_on_the_line_and_gaps_stay_empty(
    times_ns: list[int], data: st.DataObject
) -> None:
    """The recorder interpolates the differences in a recording by code of its own; both must agree."""
    values = np.array(data.draw(st.lists(ANGLES, min_size=len(times_ns), max_size=len(times_ns))))
    points = np.arange(-40_000_000, times_ns[-1] + 200_000_000, STEP_NS, dtype=np.int64)
    found = at(np.array(times_ns, np.int64), values, points)
    line = np.interp(points, times_ns, values)
    covered = np.array([
        point in times_ns
        or any(a < point < b and b - a <= 100_000_000 for a, b in itertools.pairwise(times_ns))
        for point in points
    ])  # fmt: skip
    np.testing.assert_array_equal(np.isnan(found), ~covered)
    np.testing.assert_allclose(found[covered], line[covered], atol=1e-6)
    waiting: deque[tuple[int, rows.Angles]] = deque(
        (time, (value,)) for time, value in zip(times_ns, values.tolist(), strict=True)
    )
    of_recorder = [rows.at(waiting, point) for point in points[points <= times_ns[-1]].tolist()]
    wanted = np.array([math.nan if one is None else one[0] for one in of_recorder])
    np.testing.assert_allclose(found[: len(wanted)], wanted, atol=1e-6)


def test_a_head_that_turns_through_180_degrees_takes_the_short_way() -> None:
    times = np.array([0, 40_000_000], np.int64)
    (value,) = at(times, np.array([179.0, -179.5]), np.array([STEP_NS]), circle=True)
    assert value == pytest.approx(179.75)
    (value,) = at(times, np.array([179.5, -179.0]), np.array([STEP_NS]), circle=True)
    assert value == pytest.approx(-179.75)
    (value,) = at(times, np.array([179.5, -179.0]), np.array([STEP_NS]))
    assert value == pytest.approx(0.25), "an arm has no such seam"


def test_robots_stand_side_by_side_with_units_in_the_names() -> None:
    times = [5_000_000 + k * STEP_NS for k in range(11)]
    arms = np.outer(np.arange(11.0), (1, 2, 3))
    found = grid(table(Recorded({HW: samples(times, arms), SIM: samples(times, -arms)}, {})))
    assert list(found) == [
        "time_s", "unix_time_s",
        *(
            f"bea_{side}_{name}"
            for side in ("hw", "sim")
            for name in (
                "short_deg", "middle_deg", "long_deg",
                "short_commanded_deg", "middle_commanded_deg", "long_commanded_deg",
                "short_velocity_deg_s", "middle_velocity_deg_s", "long_velocity_deg_s",
                "yaw_deg", "pitch_deg", "roll_deg",
            )
        ),
    ]  # fmt: skip
    assert found["time_s"].tolist() == [0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2]
    assert found["unix_time_s"][0] == BEGAN_NS / 1e9 + 0.02
    np.testing.assert_allclose(found["bea_hw_long_deg"], 3 * (np.arange(10) + 0.75))
    np.testing.assert_allclose(found["bea_sim_yaw_deg"], -(np.arange(10) + 0.75) + 2)


def test_notes_are_in_the_first_row_after_them() -> None:
    texts = {
        -1_000_000_000: "trial 1",
        31_000_000: "trial 2",
        39_000_000: "again",
        40_000_001: "trial 3",
        10**10: "end",
    }
    notes = tuple(Note(BEGAN_NS + at_ns, "ana", text) for at_ns, text in texts.items())
    made = Recorded({SIM: samples([k * STEP_NS for k in range(6)]), HW: samples([0])}, {}, notes)
    assert [note for block in table(made).grid() for note in block["note"]] == [
        "trial 1", None, "trial 2; again", "trial 3", None, "end"
    ]  # fmt: skip
    (part,) = table(made, 0.02, 0.06).grid()
    assert part["note"] == [None, "trial 2; again", "trial 3"]
    assert "note" not in next(table(replace(made, notes=())).grid())


def test_a_note_is_no_formula_of_a_spreadsheet() -> None:
    made = Recorded({SIM: samples([0])}, {}, (Note(BEGAN_NS, "ana", "=1+1"),))
    (block,) = table(made).grid()
    assert block["note"] == [" =1+1"]
