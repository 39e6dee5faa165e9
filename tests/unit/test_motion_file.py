"""Motion files: round trips, formats of spreadsheets, error messages; points of a recorded motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.client.motion_file import ARMS, FORM, HEAD, Place, lines_of, parse, read
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.recording.record_motion import Timed, thinned

ANGLE = st.floats(-400, 400)
TIMES = st.lists(st.floats(0, 86400), min_size=1, max_size=30).map(sorted)
HEADER = "t_s,yaw_deg,pitch_deg,roll_deg\n"


@st.composite
def paths(draw: st.DrawFn) -> list[tuple[float, Place]]:
    """Strategy for a path of the head or of the arms (s, deg)."""
    head, angles = draw(st.booleans()), st.tuples(ANGLE, ANGLE, ANGLE)
    return [(t, HeadAngles(*draw(angles)) if head else ArmAngles(*draw(angles))) for t in draw(TIMES)]


@pytest.mark.no_cover
@given(paths(), st.lists(st.text("abc #,;\"'-µ°", max_size=20), max_size=3))
def test_a_written_path_is_read_again(path: list[tuple[float, Place]], comments: list[str]) -> None:
    found = parse("".join(lines_of(path, comments)), "mine.csv")
    assert [type(point.place) for point in found.points] == [type(place) for _, place in path]
    for point, (t, place) in zip(found.points, path, strict=True):
        assert (point.t, *point.place) == pytest.approx((t, *place), abs=0.00051)
    assert not found.with_speed


@pytest.mark.no_cover
@given(
    st.text(max_size=80)
    | st.text(st.sampled_from('t_s,yawdegpitchroll0123456789.;-+e#"\n\r\t '), max_size=80)
)
def test_any_text_is_read_or_refused_in_one_line_with_the_page_of_the_format(text: str) -> None:
    for content in (text, HEADER + text):
        times, refusal = times_or_refusal(content)
        assert times == sorted(times)
        assert bool(times) != bool(refusal)
        assert not refusal or (refusal.startswith("mine.csv") and refusal.endswith(f". {FORM}"))
        assert "\n" not in refusal


def times_or_refusal(content: str) -> tuple[list[float], str]:
    try:
        return [point.t for point in parse(content, "mine.csv").points], ""
    except WrongUsage as refusal:
        return [], refusal.message


@pytest.mark.parametrize(
    "text",
    [
        "# mine\nt_s,yaw_deg,pitch_deg,roll_deg\n0,1,2,3\n0.5,1.5,-2,3\n",
        '\ufeff"# mine, and yours",,,\r\nt_s,yaw_deg,pitch_deg,roll_deg\r\n0,1,2,3\r\n0.50,1.5,-2,3\r\n,,,\r\n',
        "t_s;yaw_deg;pitch_deg;roll_deg\n0;1;2;3\n0,5;1,5;-2;3\n",
        "t_s\tyaw_deg\tpitch_deg\troll_deg\n0\t1\t2\t3\n.5\t1.5\t-2\t3",
        "roll_deg, t_s, pitch_deg, yaw_deg\n3, 0, 2, 1\n\n3, 5e-1, -2, 1.5\n",
        "t_s,yaw_deg,pitch_deg,roll_deg,,\n0,1,2,3,,\n0.5,1.5,-2,3,,\n",
        't_s,yaw_deg,pitch_deg,roll_deg\n0,1,2,3\n"0,5","1,5",-2,3\n',
        '"t_s","yaw_deg","pitch_deg","roll_deg"\n"0","1","2","3"\n"0,50","1,5","-2,0","3"\n',
        "t_s,yaw_deg,pitch_deg,roll_deg\n0,1,2,3\n5e\N{MINUS SIGN}1,1.5,\N{MINUS SIGN}2,3\n",
        't_s;yaw_deg;pitch_deg;roll_deg\n0;1;2;3\n"0,5";1,5;\N{EN DASH}2;3\n',
    ],
)
def test_formats_of_spreadsheets_are_accepted(text: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_bytes(text.encode())
    points = read(path).points
    assert [(point.t, point.place) for point in points] == [
        (0, HeadAngles(1, 2, 3)),
        (0.5, HeadAngles(1.5, -2, 3)),
    ]


BOTH = ",".join(("t_s", *HEAD, *ARMS)) + "\n"


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "mine.csv: begin with the names of the columns, t_s,yaw_deg,pitch_deg,roll_deg"),
        ("# nothing\n", "mine.csv: begin with the names of the columns, t_s,yaw_deg,pitch_deg,roll_deg"),
        (HEADER, "mine.csv: there are no points"),
        ("0,1,2,3\n", "line 1: '0' is not a column; choose from t_s, yaw_deg"),
        ("t_s,yaw_deg,pitch_deg\n", "line 1: the columns lack roll_deg"),
        ("yaw_deg,pitch_deg,roll_deg\n", "line 1: the columns lack t_s"),
        ("t_s\n", "line 1: the columns lack yaw_deg, pitch_deg, roll_deg"),
        ("t_s,t_s\n", "line 1: the column t_s occurs 2 times"),
        (HEADER + "0,1,2\n", "line 2: roll_deg is empty: give a number"),
        (HEADER + "0,1,2,3,4\n", "line 2: it has 5 cells, but the file has 4 columns"),
        (HEADER + "0,1,nan,3\n", "line 2: pitch_deg is 'nan': give a number"),
        (HEADER + '0,1,"1,000.5",3\n', "line 2: pitch_deg is '1,000.5': give a number"),
        (HEADER + "0,1,1_0,3\n", "line 2: pitch_deg is '1_0': give a number"),
        (HEADER + "0,1,1e300,3\n", "line 2: pitch_deg is 1e+300: numbers up to 3.4e38 are allowed"),
        (HEADER + "-1,1,2,3\n", "line 2: t_s is -1: give a number of seconds from 0"),
        (HEADER + "1,1,2,3\n0.5,1,2,3\n", "line 3: t_s is 0.5, earlier than in the line before (1)"),
        (HEADER + '0,"1,2,3\n', "line 2: unexpected end of data"),
        (BOTH + "0,1,2,3,4,5,6\n", "line 2: give the angles of the head or those of the arms, not both"),
        (BOTH + "0,,,,,,\n", "line 2: give the angles of the head or those of the arms"),
    ],
)
def test_errors_are_reported_with_their_line(text: str, what: str) -> None:
    with pytest.raises(WrongUsage) as refusal:
        parse(text, "mine.csv")
    assert what in refusal.value.message


def test_a_file_that_never_ends_is_refused() -> None:
    with pytest.raises(WrongUsage, match="not a regular file"):
        read(Path("/dev/zero"))


# -- a recorded motion: enough points for a replay, two for a rest ---------------------------------

TURNS = st.lists(
    st.tuples(st.floats(-30, 30), st.integers(1, 60), st.integers(0, 60)), min_size=1, max_size=4
)


def published(turns: list[tuple[float, int, int]]) -> list[Timed]:
    """Return 50 points per second of an arm; each turn has an angle (deg) and numbers of moving and resting points."""
    angles = [0.0]
    for by, moving, resting in turns:
        angles += [angles[-1] + by * (k + 1) / moving for k in range(moving)]
        angles += [angles[-1]] * resting
    return [(k * 0.02, ArmAngles(angle, 0.0, 0.0)) for k, angle in enumerate(angles)]


@given(TURNS, st.sampled_from([0.02, 0.04, 0.05, 0.1]))
@settings(deadline=None)
def test_omitted_points_lie_between_kept_points(turns: list[tuple[float, int, int]], period_s: float) -> None:
    points = published(turns)
    kept = thinned(points, period_s)
    assert kept[0] == points[0]
    assert kept[-1] == points[-1]
    t = np.array([point[0] for point in kept])
    assert (np.diff(t) > 0).all()
    between = np.interp([point[0] for point in points], t, [point[1][0] for point in kept])
    steps = np.abs(np.diff([point[1][0] for point in points], prepend=0.0))
    most = max(steps) * (period_s / 0.02 + 1) + 0.01
    assert between == pytest.approx([point[1][0] for point in points], abs=most)


def test_rests_at_start_and_end_are_shortened() -> None:
    whole = published([(0.0, 100, 0), (20.0, 10, 0), (0.0, 200, 0)])
    assert thinned(whole, 0.04)[-1][0] == pytest.approx(6.2), "the whole rests"
    kept = thinned(whole, 0.04, 0.5)
    assert kept[-1][0] == pytest.approx(0.5 + 0.2 + 0.5, abs=0.05)
    assert [place for _, place in kept] == [place for _, place in thinned(whole, 0.04)]
