"""`beatrix graph`: the programs at the router, as text, JSON and a drawing."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from class_router import Answering, replies
from robots import until
from router_storm import SEATS, storm
from shell import NAME, Shell

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus.sessions import program_name
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Clock, ProgramInfo

NODES = {f"{NAME} (sim)", f"{NAME} (hw)"}
SEAT = f"seat ana: {program_name(sys.argv)}"


def programs(shell: Shell) -> dict[str, dict[str, Any]]:
    """Return the programs that `beatrix graph` lists, by title."""
    return {row["title"]: row for row in shell.json("graph", "--who", "teacher")["programs"]}


def test_graph_shows_who_watches_and_who_asks_which_robot(shell: Shell, tmp_path: Path) -> None:
    with shell.robot("hw") as robot, robot.stream() as readings:
        readings.next()
        robot.stop()
        rows = programs(shell)
        assert rows.keys() >= {*NODES, SEAT}
        assert {f"beatrix/{NAME}/hw/stop", f"beatrix/{NAME}/hw/stop/*"} <= {*rows[f"{NAME} (hw)"]["serves"]}
        assert f"beatrix/{NAME}/hw/state/positions" in rows[f"{NAME} (hw)"]["publishes"]
        assert rows[SEAT]["subscribes"] == [f"beatrix/{NAME}/hw/state/positions"]
        assert f"beatrix/{NAME}/hw/stop/ana" in rows[SEAT]["asks"]
        shown = shell.good("graph")
        assert f"watches {NAME} (hw): state/positions" in shown
        assert f"asks {NAME} (hw): stop" in shown
        assert f"asks {NAME} (sim)" not in shown
        shell.good("graph", "--svg", str(tmp_path / "graph.svg"))
        drawn = ET.parse(tmp_path / "graph.svg").getroot()  # the drawing that this test has written
        texts = {element.text for element in drawn.iter("{http://www.w3.org/2000/svg}text")}
        assert texts >= {*NODES, SEAT, "state/positions", "stop"}
    until(lambda: SEAT not in programs(shell), "ana has left")


def test_the_pictures_of_a_second_session_belong_to_the_same_program(shell: Shell) -> None:
    with shell.robot("sim") as robot, robot.camera("left"):
        assert programs(shell)[SEAT]["subscribes"] == [f"beatrix/{NAME}/sim/state/camera/left"]


def test_a_program_that_does_not_describe_itself_is_listed_without_keys(shell: Shell) -> None:
    with zbus.connect(shell.endpoint) as bus:
        bus.declare_token(keys.seat("ben", bus.session_id))
        assert programs(shell)["seat ben"]["described"] is False
        assert "seat ben\n  does not describe itself" in shell.good("graph")


def test_a_description_with_wrong_keys_or_of_another_type_does_no_harm(shell: Shell) -> None:
    with zbus.connect(shell.endpoint) as bus:
        wrong = ProgramInfo(program="odd", subscribes=["/", "a//b", "#", ""], asks=["beatrix"])
        payloads = {
            "odd": codec.encode(wrong),
            "odder": b"\xff",
            "oddest": codec.encode(Clock(t_mono_ns=1, t_wall_ns=2)),
        }
        for who, payload in payloads.items():
            Answering(bus, keys.program(who, bus.session_id), payload=payload)
        shown = shell.good("graph")
    assert "seat odd: odd\n  watches and asks no robot" in shown
    assert f"{NAME} (hw)" in shown


def test_the_router_answers_nothing_about_itself(shell: Shell) -> None:
    with zbus.connect(shell.endpoint) as bus:
        for selector in ("@/**", "@/*/router/**", "@/*/router"):
            assert [key for key, _ in replies(bus, selector) if bus.session_id not in key] == []


@pytest.mark.alone
def test_the_router_answers_while_twelve_seats_come_and_go() -> None:
    after = storm(10.0)
    assert not after.trouble
    assert after.done["seat"] > 5 * SEATS
    assert all(after.done[verb] > 5 for verb in ("graph", "ls", "top", "stop")), after.done
    assert after.seen > 2, "graph has shown seats that came and went"


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["/home/ana/lesson.py", "3"], "lesson.py"),
        (["/usr/bin/beatrix", "gui", "--name", "bea"], "beatrix gui"),
        (["/x/beatrix_zenoh/cli/__main__.py", "graph"], "beatrix graph"),
        (["/x/hw_node/__main__.py", "--name", "bea"], "hw_node"),
        (["-c"], "python"),
        ([""], "python"),
        ([], "python"),
    ],
)
def test_the_name_of_a_program_is_that_of_its_file_or_its_verb(words: list[str], name: str) -> None:
    assert program_name(words) == name


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
