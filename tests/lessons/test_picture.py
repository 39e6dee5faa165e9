"""The picture of a check: valid SVG in both languages, whatever was measured, and a file only while it is current."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.lessons.checking import Result, Verdict, keep_picture
from beatrix_zenoh.lessons.picture import WORDS, Panel, svg

NUMBERS = st.floats(-1e6, 1e6) | st.just(float("nan"))


@settings(max_examples=60, deadline=None)
@given(st.lists(NUMBERS, min_size=2, max_size=700), st.sampled_from([*WORDS]), st.booleans())
def test_each_curve_is_drawn_within_its_panel(values: list[float], language: str, asked: bool) -> None:
    done = np.array(values)
    panel = Panel("a < b (°)", np.arange(len(done)) / 50, done, -done if asked else None, ((20, np.inf),))
    root = ET.fromstring(svg([panel, panel], language))
    height = float(root.attrib["height"])
    lines = [one for one in root if one.tag.endswith("polyline")]
    assert len(lines) == (4 if asked else 2)
    for point in (point for line in lines for point in line.attrib["points"].split()):
        x, y = map(float, point.split(","))
        assert 0 <= x <= 720
        assert 0 <= y <= height


@pytest.mark.parametrize("picture", ["<svg/>", ""])
def test_no_picture_of_an_earlier_check_is_left(picture: str, tmp_path: Path) -> None:
    file = tmp_path / "lesson-1.svg"
    file.write_text("old")
    assert keep_picture(Verdict(Result.NOT_YET, picture=picture), file) == (file if picture else None)
    assert file.exists() is bool(picture)
