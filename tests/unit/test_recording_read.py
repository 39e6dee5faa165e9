"""Reading of recordings: all written rows are read."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest
from golden import same
from recorded_values import SCALARS, STATE, TEXT, recorded_values
from written_recordings import BEGAN_NS, STEP_NS, write_lesson

from beatrix_zenoh.contract._generated.messages import Info, LimitInfo
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.recording.rows import (
    Bar,
    BodyTurn,
    Line,
    Numbers,
    RecordingRow,
    of_difference,
    of_model,
    of_robot,
)
from beatrix_zenoh.recording.rrd.read import read, read_about
from beatrix_zenoh.recording.rrd.stream import RowStream
from beatrix_zenoh.recording.samples import About
from beatrix_zenoh.recording.viewer import verify

SIM, HW = ("bea", "sim"), ("bea", "hw")


def sample(place: tuple[str, str], index: int) -> list[RecordingRow]:
    """Return the rows of the sample with this index."""
    time_ns, robot_ns = BEGAN_NS + index * STEP_NS, BEGAN_NS + index * STEP_NS - 7
    what: list[RecordingRow] = [
        Numbers(of_robot(place, name), time_ns, robot_ns, (index + k, k, -index))
        for k, name in enumerate(("arms", "commanded", "head"))
    ]
    return [
        *what,
        BodyTurn(of_model(place, "head"), time_ns, robot_ns, (0.0, 0.0, 0.0, 1.0)),
    ]


def test_samples_events_states_and_differences_are_written_and_read(tmp_path: Path) -> None:
    path = tmp_path / "lesson.rrd"
    other = [
        Line(of_robot(SIM, "events"), BEGAN_NS, BEGAN_NS, "ana stop: At rest.", "ERROR"),
        Line(of_robot(SIM, "events"), BEGAN_NS, BEGAN_NS, "ben look: Refused.", "WARN"),  # at the same time
        Bar(of_robot(SIM, "state"), BEGAN_NS, BEGAN_NS, "ready"),
        Bar(of_robot(SIM, "state"), BEGAN_NS + STEP_NS, BEGAN_NS, "moving"),
        Numbers(of_difference("bea", "arms"), BEGAN_NS, BEGAN_NS, (1.0, 2.0, 3.0)),
    ]
    samples = [row for index in range(10) for place in (SIM, HW) for row in sample(place, index)]
    write_lesson(path, [SIM, HW], 0, [*samples, *other])
    assert verify(path) == ""
    recorded = read(path)
    assert list(recorded.robots) == [HW, SIM]
    for found in recorded.robots.values():
        assert found.time_ns.tolist() == [BEGAN_NS + index * STEP_NS for index in range(10)]
        assert found.robot_ns.tolist() == [BEGAN_NS + index * STEP_NS - 7 for index in range(10)]
        for k, angles in enumerate((found.arms, found.commanded, found.head)):
            np.testing.assert_array_equal(angles, [(index + k, k, -index) for index in range(10)])
        assert np.isnan(found.head_measured).all()
    for entity, component, values in (
        (of_robot(SIM, "events"), TEXT, ["ana stop: At rest.", "ben look: Refused."]),
        (of_robot(SIM, "state"), STATE, ["ready", "moving"]),
        (of_difference("bea", "arms"), SCALARS, [1.0, 2.0, 3.0]),
    ):
        assert recorded_values(path, entity, component) == values


def test_a_recording_says_what_it_is(tmp_path: Path) -> None:
    """A later description replaces an earlier one, as robots and seats come."""
    path = tmp_path / "lesson.rrd"
    first = About(BEGAN_NS, "0.1.0", "abc", "Lesson 2", "trial 3", "ana")
    limits = LimitInfo(
        tilt_max=0.6, gap_min=0.5, yaw_max=3.1, speed_default=1.0, speed_max=1.5, acceleration=3.0
    )
    info = Info(
        robot="bea", side="sim", version="0.1.0", contract="abc", firmware="1.2.0", steps_per_turn=4184.6,
        arms=[], limits=limits, fingerprint="0123abcd", commands=[], reasons=[],
        keys=[], examples=[],
    )  # fmt: skip
    last = first.with_seat("ben").with_seat("ana").with_seat("").with_robot(SIM, info).with_robot(SIM, info)
    stream = RowStream("one", path.stem)
    stream.to_file(path)
    stream.describe(first)
    stream.send([*sample(SIM, 0), Numbers(of_robot(SIM, "clock"), BEGAN_NS, BEGAN_NS, (-12.5, 0.25))])
    assert stream.flush(30.0)
    stream.describe(last)
    assert stream.flush(30.0)
    stream.close()
    recorded = read(path)
    assert recorded.about == last
    assert last.seats == ("ana", "ben")
    assert [str(robot) for robot in last.robots] == [
        "bea (sim): beatrix 0.1.0, firmware 1.2.0, contract abc, robot file 0123abcd"
    ]
    assert recorded_values(path, of_robot(SIM, "clock"), SCALARS) == [-12.5, 0.25]
    assert read_about(path) == last
    assert last.lines() == [
        "Lesson 2, begun 2025-11-13 02:13:20 UTC by ana with beatrix 0.1.0.",
        "Note: trial 3",
        "bea (sim): beatrix 0.1.0, firmware 1.2.0, contract abc, robot file 0123abcd.",
        "Requests and notes came from ana, ben.",
    ]
    other = msgspec.structs.replace(info, fingerprint="fedc")
    (warning,) = last.with_robot(HW, other).with_robot(("ada", "hw"), other).warnings()
    same("recording read.a recording says what it is", warning)


def test_a_file_that_is_no_recording_of_positions_is_refused(tmp_path: Path) -> None:
    for name, content, words in (
        ("missing.rrd", None, "there is no such file"),
        ("text.rrd", "no recording", "is not a recording"),
        ("nothing.rrd", "", "is empty"),
        ("mine.csv", "t_s,yaw_deg,pitch_deg,roll_deg\n", "is a motion file.* use `beatrix replay"),
        ("empty.rrd", None, "no positions"),
    ):
        if content is not None:
            (tmp_path / name).write_text(content)
        elif name == "empty.rrd":
            write_lesson(tmp_path / name, [], 0)
        with pytest.raises(Refused, match=words) as refused:
            read(tmp_path / name)
        assert "--repair" not in str(refused.value)
