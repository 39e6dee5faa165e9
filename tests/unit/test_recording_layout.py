"""The tabs of a recording: each view that the page promises, and what it draws."""

from __future__ import annotations

import re
from typing import cast

from rerun import blueprint as rrb
from robots import ROOT

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.recording.rows import RobotSet
from beatrix_zenoh.recording.rrd.scene import SOUND, TABS, Part, layout, of_place

SIM, HW = ("bea", "sim"), ("bea", "hw")
BOTH = {SIM: Figure(), HW: Figure()}
PAGE = ROOT / "docs/how-to/record.md"
ARMS = "arms (°): hardware wide, simulation thin and pale"


def tabs(shown: RobotSet) -> list[str]:
    """Return the titles of the outermost tabs."""
    return [str(part.name) for part in inside(layout(shown).root_container)]


def inside(part: rrb.Container) -> list[Part]:
    """Return the parts of a container."""
    return cast("list[Part]", part.contents)


def views(part: Part) -> dict[str, rrb.View]:
    """Return all views inside a part by their titles, in order."""
    if isinstance(part, rrb.View):
        return {str(part.name): part}
    return {title: view for inner in inside(part) for title, view in views(inner).items()}


def draws(view: rrb.View) -> set[str]:
    """Return the entities that a view draws, without the mechanism."""
    rules = cast("list[str]", view.contents)
    return {rule.removeprefix("+ ") for rule in rules if "/mechanism" not in rule}


def test_the_tabs_are_those_of_the_page() -> None:
    seen = PAGE.read_text(encoding="utf-8").partition("## What you see")[2].partition("\n## ")[0]
    assert re.findall(r"^\*\*(.+?)\*\*:", seen, re.MULTILINE) == list(TABS) == tabs(RobotSet(BOTH))
    assert tabs(RobotSet({SIM: Figure()}, with_sound=frozenset([SIM]))) == [*TABS, SOUND]


def test_the_views_draw_what_is_recorded() -> None:
    found = views(layout(RobotSet(BOTH, frozenset(BOTH))).root_container)
    solid, ghost = (
        {f"/bea/{{}}/model/{path}/{kind}" for path in Figure.paths} for kind in ("solid", "ghost")
    )
    hw, sim, ghosts = (
        {one.format(side) for one in part} for part, side in ((solid, "hw"), (solid, "sim"), (ghost, "sim"))
    )
    recorded = {f"/{path}" for place, figure in BOTH.items() for path, _ in of_place(place, figure)}
    assert hw | sim | ghosts <= recorded
    assert draws(found["bea: hardware, and the simulation as a blue ghost"]) == hw | ghosts
    assert (draws(found["bea: simulation"]), draws(found["bea: hardware"])) == (sim, hw)
    assert found["left eye, hardware"].origin == "/bea/hw/camera/left"
    assert {"right eye, simulation", "states", "requests, replies and refusals"} <= found.keys()
    assert draws(found[ARMS]) == {"/bea/sim/arms", "/bea/hw/arms"}
    assert draws(found["head: hardware − simulation (°)"]) == {"/bea/difference/head"}
