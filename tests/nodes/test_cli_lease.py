"""`beatrix lease`, `freeze`, `unfreeze` and `limit`, on robots in real processes."""

from __future__ import annotations

import signal

import pytest
from robots import Stage, until
from shell import NAME, Shell

from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.cli import commands
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseQuery


def test_a_robot_is_held_until_ctrl_c(free: Shell) -> None:
    holder = free.start("lease", "take", "--on", "hw")
    with free.robot("hw") as robot:
        until(lambda: robot.status().lease != 0, "ana has taken it")
        refused = free.run("look", "--yaw", "5", "--on", "hw", "--who", "dora")
        assert (refused.returncode, "ana has taken this robot" in refused.stderr) == (1, True)
        assert "ana has taken it." in free.good("ls")
        free.good("look", "--yaw", "2", "--on", "hw")
        holder.send_signal(signal.SIGINT)
        output, _ = holder.communicate(timeout=10)
        assert "held by ana" in output
        until(lambda: not robot.status().lease, "given back")


def test_a_seat_that_waits_gets_the_robot(free: Shell) -> None:
    with free.robot("sim") as robot, robot.lease():
        waiting = free.start("lease", "take", "--on", "sim", "--who", "dora", "--wait", "20")
        until(lambda: robot.status().waiting == ["dora"], "dora waits")
    assert waiting.stdout is not None
    assert any("held by dora" in line for line in waiting.stdout)
    given = free.good("lease", "give-back", "--on", "sim", "--who", "dora")
    assert "the place in the queue has ended" in given
    output, _ = waiting.communicate(timeout=20)
    assert (waiting.returncode, "your lease has ended; driver now: none" in output) == (1, True)


def test_the_teacher_mutes_a_seat_on_all_robots_and_ends_a_turn(free: Shell) -> None:
    boss = ("--who", "teacher")
    refused = free.run("mute", "ben")
    assert (refused.returncode, "ana is not the teacher's seat" in refused.stderr) == (1, True)
    assert free.good("mute", "ana", *boss).count("ana is muted: it only watches") == 2
    for command in (("top", "--once"), ("ls",)):
        assert "beatrix unmute SEAT" in free.good(*command)
    for words in ("look --yaw 5", "enable", "lease take", "stop"):
        refused = free.run(*words.split(), "--on", "sim")
        assert (refused.returncode, "beatrix unmute ana" in refused.stderr) == (1, True)
    free.good("unmute", "ana", *boss)
    with free.robot("hw") as robot:
        motion = robot.look(yaw=60, speed=20, wait=False)
        assert "The turn of ana has ended" in free.good("lease", "give-back", "--on", "hw", *boss)
        assert motion.exception(5.0) is not None


def test_a_decision_that_every_robot_refuses_is_not_kept_for_robots_that_are_not_online(
    free: Shell, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: list[LeaseQuery] = []

    def pending(_: object, query: LeaseQuery, __: object) -> dict[str, str]:
        kept.append(query)
        return {}

    monkeypatch.setattr(commands, "pending", pending)
    for words, code, decisions in (("limit 5000", 1, 0), ("limit --turn 0.1", 1, 0), ("unfreeze", 0, 1)):
        done = free.run(*words.split(), "--who", "teacher")
        assert (done.returncode, len(kept)) == (code, decisions), done.stderr


def test_the_teacher_freezes_all_robots_and_limits_their_speed(free: Shell) -> None:
    refused = free.run("freeze")
    assert (refused.returncode, "ana is not the teacher's seat" in refused.stderr) == (1, True)
    rows = free.json("freeze", "--who", "teacher")["robots"]
    assert {(row["robot"], row["side"], row["result"]) for row in rows} == {
        (NAME, "sim", True),
        (NAME, "hw", True),
    }
    assert {row["state"] for row in free.json("ls")["robots"]} == {"frozen"}
    assert "beatrix unfreeze" in free.good("top", "--once")
    refused = free.run("look", "--yaw", "5", "--on", "sim")
    assert (refused.returncode, "frozen" in refused.stderr) == (1, True)
    free.good("unfreeze", "--who", "teacher")
    assert "at most 20°/s" in free.good("limit", "20", "--who", "teacher")
    nothing = free.run("limit", "0", "--who", "teacher")
    assert (nothing.returncode, "beatrix limit off" in nothing.stderr) == (2, True)
    refused = free.run("look", "--yaw", "5", "--speed", "60", "--on", "sim")
    assert (refused.returncode, "20.0°/s" in refused.stderr) == (1, True)
    free.good("limit", "off", "--who", "teacher")
    assert {row["speed_limit_deg_s"] for row in free.json("top", "--once")["robots"]} == {0.0}
    for nonsense in (("slow",), ("--turn", "short")):
        assert free.run("limit", *nonsense, "--who", "teacher").returncode == 2
    for longest, words in (("60", "at most 60 s"), ("off", "at most 120 s")):
        assert words in free.good("limit", "--turn", longest, "--who", "teacher")


@pytest.mark.long("waits for robots that do not answer")
def test_a_robot_that_freeze_did_not_reach_is_named_and_shown_as_not_frozen() -> None:
    with Stage() as stage:
        shell = Shell(stage.endpoint)
        stage.node("bea1")
        waiting: list[Incoming] = []
        hung = stage.client("bea2").bus  # a node that takes requests and does not answer
        hung.declare_token(keys.alive("bea2", "hw"))
        hung.serve(keys.lease("bea2", "hw", "*"), waiting.append)
        done = shell.run("freeze", "--who", "teacher")
        assert done.returncode != 0
        assert done.stdout.startswith("bea1 (hw): The robot is frozen")
        assert "bea2 (hw): The robot did not answer within 2 s, so its state is not known" in done.stderr
        assert "Not done, or not online: bea2 (hw)." in done.stderr
        hung.close()
        orders: tuple[tuple[str, ...], ...] = ("freeze",), ("mute", "cem"), ("limit", "20")
        for order in orders[1:]:
            shell.good(*order, "--who", "teacher")
        stage.node("bea2")  # the node returns without all this
        assert len(waiting) == 1
        line = "differ: bea1 (hw) frozen, at most 20°/s, cem muted, bea2 (hw) none."
        assert line in shell.good("top", "--once")
        for order in orders:
            shell.good(*order, "--who", "teacher")
        assert "differ" not in shell.good("top", "--once")
