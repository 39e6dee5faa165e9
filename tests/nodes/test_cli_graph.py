"""`beatrix graph`: the programs at the router, as text and JSON."""

from __future__ import annotations

import sys
from typing import Any

from class_router import replies
from robots import until
from shell import NAME, Shell

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus.sessions import program_name

NODES = {f"{NAME} (sim)", f"{NAME} (hw)"}
SEAT = f"seat ana: {program_name(sys.argv)}"


def programs(shell: Shell) -> dict[str, dict[str, Any]]:
    """Return the programs that `beatrix graph` lists, by title."""
    return {row["title"]: row for row in shell.json("graph", "--who", "teacher")["programs"]}


def test_graph_shows_who_watches_and_who_asks_which_robot(shell: Shell) -> None:
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
    until(lambda: SEAT not in programs(shell), "ana has left")


def test_the_router_answers_nothing_about_itself(shell: Shell) -> None:
    with zbus.connect(shell.endpoint) as bus:
        for selector in ("@/**", "@/*/router/**", "@/*/router"):
            assert [key for key, _ in replies(bus, selector) if bus.session_id not in key] == []
