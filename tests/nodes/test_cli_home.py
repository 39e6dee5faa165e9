"""`beatrix home` for both robots: it says which of them moves."""

from __future__ import annotations

import json

import pytest
from shell import Shell


def test_home_of_both_robots_says_which_of_them_moves(shell: Shell) -> None:
    for on, says in (("both", "Both move now"), ("sim", "Only the simulation"), ("hw", "Only the hardware")):
        shell.good("look", "--yaw", "10", "--on", on)
        assert says in shell.run("home", "--on", "both").stderr
    done = shell.run("home", "--on", "both", "--json")
    assert "Both are there already." in done.stderr
    rows = json.loads(done.stdout)["robots"]
    assert [row["arms_deg"]["short"] for row in rows] == pytest.approx([0, 0], abs=0.5)
