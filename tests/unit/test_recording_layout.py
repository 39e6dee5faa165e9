"""The tabs of a recording, read from its file: each view that the page promises, and what it draws."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from recording_views import Box, View, solids, tabs_of
from robots import ROOT

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.recording.rows import (
    Bar,
    BarState,
    BodyTurn,
    Frame,
    Line,
    Numbers,
    RecordingRow,
    RobotSet,
    of_difference,
    of_model,
    of_robot,
)
from beatrix_zenoh.recording.rrd.scene import TABS
from beatrix_zenoh.recording.rrd.stream import RowStream

Place = tuple[str, str]
SIM, HW = ("bea", "sim"), ("bea", "hw")
BEGAN_NS = 1_763_000_000_000_000_000
PAGE = ROOT / "docs/how-to/record.md"
ANGLES = (1.0, 2.0, 3.0)


def rows_of(place: Place) -> list[RecordingRow]:
    """Return one row of each kind for a robot."""
    at = (BEGAN_NS, BEGAN_NS)
    turns = Figure().rotations(Neck().inverse(0, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    return [
        *(BodyTurn(of_model(place, body), *at, turn) for body, turn in turns.items()),
        *(
            Numbers(of_robot(place, what), *at, ANGLES)
            for what in ("arms", "commanded", "head", "head_measured")
        ),
        *(Frame(of_robot(place, "camera", eye), *at, b"\xff\xd8") for eye in ("left", "right")),
        Line(of_robot(place, "events"), *at, "ana look accepted", "INFO"),
        Bar(of_robot(place, "state"), *at, BarState.READY),
    ]


@pytest.fixture(scope="module")
def sides(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of both robots, which appear one after the other, and their pictures last."""
    path = tmp_path_factory.mktemp("sides") / "lesson.rrd"
    stream = RowStream("one", "lesson")
    stream.to_file(path)
    both = {SIM: Figure(), HW: Figure()}
    for shown in (RobotSet({SIM: Figure()}), RobotSet(both), RobotSet(both, frozenset(both))):
        stream.show(shown)
    stream.send([*rows_of(SIM), *rows_of(HW)])
    stream.send(
        [Numbers(of_difference("bea", what), BEGAN_NS, BEGAN_NS, ANGLES) for what in ("arms", "head")]
    )
    assert stream.flush(30.0)
    stream.close()
    return path


def shape(part: Box | View) -> object:
    """Return how views are arranged: a container with its parts, or the title of a view."""
    return part.title if isinstance(part, View) else (part.kind, [shape(inner) for inner in part.parts])


def test_the_tabs_are_those_of_the_page(sides: Path) -> None:
    seen = PAGE.read_text(encoding="utf-8").partition("## What you see")[2].partition("\n## ")[0]
    assert re.findall(r"^\*\*(.+?)\*\*:", seen, re.MULTILINE) == list(TABS) == list(tabs_of(sides))


def test_overlay_draws_the_hardware_and_the_simulation_as_a_ghost(sides: Path) -> None:
    (view,) = tabs_of(sides)["Overlay"].views
    assert (view.kind, view.title) == ("3D", "bea: hardware, and the simulation as a blue ghost")
    assert set(solids(HW, "solid", view.draws)) == set(solids(SIM, "ghost", view.draws)) == set(Figure.paths)
    assert not list(solids(SIM, "solid", view.draws))


def test_side_by_side_draws_each_robot_in_a_view_of_its_own_and_its_eyes_beside_it(sides: Path) -> None:
    tab = tabs_of(sides)["Side by side"]
    sim_eyes, hw_eyes = (
        ("vertical", [f"{eye} eye, {side}" for eye in ("left", "right")])
        for side in ("simulation", "hardware")
    )
    assert shape(tab) == (
        "horizontal",
        [("horizontal", [sim_eyes, "bea: simulation", "bea: hardware", hw_eyes])],
    )
    pictures = [*tab.views[:2], *tab.views[4:]]
    sim, hw = tab.views[2:4]
    assert (sim.kind, hw.kind, {view.kind for view in pictures}) == ("3D", "3D", {"2D"})
    for view, own in ((sim, SIM), (hw, HW)):
        assert set(solids(own, "solid", view.draws)) == set(Figure.paths)
        assert all(
            entity.startswith((f"/{'/'.join(own)}/model/", f"/{'/'.join(own)}/mechanism/"))
            and not entity.endswith("/ghost")
            for entity in view.draws
        )
    assert [set(view.draws) for view in pictures] == [
        {f"/bea/{side}/camera/{eye}"} for side in ("sim", "hw") for eye in ("left", "right")
    ]
    assert sim.settings["EyeControls3D"] == hw.settings["EyeControls3D"], "both are seen from the same point"
