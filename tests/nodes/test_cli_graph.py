"""`beatrix graph`: the programs at the router, as text, JSON and a drawing."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from shell import NAME, Shell
from stage import until

from beatrix_zenoh import bus as zbus

NODES = {f"{NAME} (sim)", f"{NAME} (hw)"}


def test_graph_shows_nodes_seats_and_their_subscriptions(shell: Shell, tmp_path: Path) -> None:
    with shell.robot("hw") as robot, robot.stream() as readings:
        readings.next()
        rows = {row["title"]: row for row in shell.json("graph", "--who", "teacher")["programs"]}
        assert rows.keys() >= {*NODES, "seat ana"}
        assert {f"beatrix/{NAME}/hw/stop", f"beatrix/{NAME}/hw/stop/*"} <= {*rows[f"{NAME} (hw)"]["serves"]}
        assert rows["seat ana"]["subscribes"] == [f"beatrix/{NAME}/hw/state/positions"]
        assert f"{NAME} (hw): state/positions" in shell.good("graph")
        shell.good("graph", "--svg", str(tmp_path / "graph.svg"))
        drawn = ET.parse(tmp_path / "graph.svg").getroot()  # the drawing that this test has written
        texts = {element.text for element in drawn.iter("{http://www.w3.org/2000/svg}text")}
        assert texts >= {*NODES, "seat ana", "state/positions"}
    until(lambda: "seat ana" not in shell.good("graph", "--who", "teacher"), "ana has left")


@pytest.mark.parametrize(
    ("expression", "key", "wanted"),
    [
        ("beatrix/*/*/state/status", "beatrix/bea/hw/state/status", True),
        ("beatrix/*/sim/state/status", "beatrix/bea/hw/state/status", False),
        ("beatrix/**", "beatrix/bea/hw/state/status", True),
        ("**/status", "beatrix/bea/hw/state/status", True),
        ("beatrix/*", "beatrix/bea/hw", False),
        ("beatrix/bea/**", "beatrix/bea", True),
    ],
)
def test_key_expressions_intersect_only_keys_that_they_match(expression: str, key: str, wanted: bool) -> None:
    assert zbus.intersects(expression, key) is wanted
