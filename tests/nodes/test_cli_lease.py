"""`beatrix lease`, `freeze`, `unfreeze` and `limit`, on robots in real processes."""

from __future__ import annotations

import signal

import pytest
from robots import Stage, until
from shell import NAME, Shell

from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.contract._generated import keys


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
    assert (waiting.returncode, "your lease has ended; it is free now" in output) == (1, True)


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
def test_a_robot_that_freeze_did_not_reach_is_named_and_shown_as_not_frozen(alone: Stage) -> None:
    shell = Shell(alone.endpoint)
    alone.node("bea1")
    waiting: list[Incoming] = []
    hung = alone.client("bea2").bus  # a node that takes requests and does not answer
    hung.declare_token(keys.alive("bea2", "hw"))
    hung.serve(keys.lease("bea2", "hw", "*"), waiting.append)
    done = shell.run("freeze", "--who", "teacher")
    assert done.returncode != 0
    assert done.stdout.startswith("bea1 (hw): The robot is frozen")
    assert "bea2 (hw): The robot did not answer within 2 s, so its state is not known" in done.stderr
    assert "Not done, or not online: bea2 (hw)." in done.stderr
    hung.close()
    alone.node("bea2")  # the node returns, not frozen
    assert len(waiting) == 1
    line = "Not frozen, although others are: bea2 (hw)."
    assert line in shell.good("top", "--once")
    frozen = {row["robot"]: row["frozen"] for row in shell.json("top", "--once")["robots"]}
    assert frozen == {"bea1": True, "bea2": False}
    shell.good("freeze", "--who", "teacher")
    assert line not in shell.good("top", "--once")


@pytest.mark.long("starts a robot twice")
def test_a_robot_that_returns_without_a_mute_or_limit_of_the_others_is_named(alone: Stage) -> None:
    shell = Shell(alone.endpoint)
    alone.node("bea1")
    orders = ("mute", "cem"), ("limit", "20")
    for order in orders:
        shell.good(*order, "--who", "teacher")
    alone.node("bea2")
    lines = (
        "cem is muted, but not at bea2 (hw). The teacher mutes it at all with `beatrix mute cem`.",
        "The teacher's speed limits differ: bea1 (hw) 20°/s, bea2 (hw) none.",
    )
    for there in (True, False):
        shown = shell.good("top", "--once")
        assert [line in shown for line in lines] == [there, there]
        for order in orders:
            shell.good(*order, "--who", "teacher")
