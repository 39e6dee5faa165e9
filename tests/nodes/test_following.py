"""A simulation that follows: real processes of both robots, driven by raw Zenoh queries."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from following_lag import lag_s, largest_step_deg, series
from late_tests import in_time
from old_programs import Program
from published import published_positions
from robots import Stage, ask_raw, until, wait_status
from shell import Shell

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import FollowState, LeaseAction, Positions, Reason

LAG_S = 0.06


class Both:
    """Simulation and hardware of one name, and their published positions."""

    def __init__(self, stage: Stage, terminal: Path) -> None:
        """`terminal`: the port of the simulation for programs of 2023."""
        self.stage, self.terminal = stage, terminal
        # The teacher's requests need not wait for the end of another seat's lease.
        self.hw, self.sim = stage.robot("bea", "hw", "teacher"), stage.robot("bea", "sim")
        self._hw, self._sim = published_positions(self.hw), published_positions(self.sim)

    def ready(self) -> Both:
        """Let the simulation follow a calibrated hardware at its home."""
        self.hw.disable()
        if self.sim.status().following is not FollowState.OFF:
            self.wait(FollowState.WAITING)  # else the wait below would see the state of before
        self.hw.enable()
        self.hw.calibrate()
        if self.sim.status().following is FollowState.OFF:
            self.sim.enable()
            if not self.sim.status().calibrated:
                self.sim.calibrate()
            until(self.begins, "the simulation follows")
        self.wait(FollowState.FOLLOWING)
        self.together()
        return self

    def begins(self) -> bool:
        try:
            return self.sim.follow().result
        except Refused as refused:
            if refused.reason in (Reason.STOPPED, Reason.NOT_AT_REST):  # it comes to rest
                return False
            raise

    def wait(self, state: FollowState) -> None:
        wait_status(self.sim, lambda status: status.following is state, state)

    def together(self) -> None:
        """Wait until both robots have the same set points."""

        def same() -> bool:
            here, there = self.sim.positions(), self.hw.positions()
            return max(abs(a - b) for a, b in zip(here.commanded, there.commanded, strict=True)) < 0.01

        until(same, "the same set points")

    def record(self, drive: Callable[[], object]) -> tuple[list[Positions], list[Positions]]:
        """Return the positions of hardware and simulation while `drive` moves the hardware."""
        begin = len(self._hw.all), len(self._sim.all)
        self._next(25)
        drive()
        self._next(30)
        return self._hw.all[begin[0] :], self._sim.all[begin[1] :]

    def _next(self, count: int) -> None:
        for published in (self._hw, self._sim):
            newest = published.all[-1].seq
            published.next(lambda one, newest=newest: one.seq >= newest + count)  # type: ignore[misc]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Both]:
    path = tmp_path_factory.mktemp("legacy") / "COM4"
    with Stage() as stage:
        stage.hardware("bea")
        stage.simulation("bea", "--follow", "--eyes-hz", "0", "--legacy", str(path))
        yield Both(stage, path)


@pytest.fixture
def both(served: Both) -> Both:
    return served.ready()


def checked_lag(hardware: list[Positions], simulation: list[Positions]) -> None:
    """Check the lag of the measured arms, what remains without it, and that no set point jumps."""
    turned = series(hardware, "commanded")[1]
    assert float((turned.max(axis=0) - turned.min(axis=0)).max()) > 3, "the hardware has moved"
    lag, difference = lag_s(series(hardware), series(simulation))
    in_time(lag, LAG_S, "lag of the simulation")
    assert difference < 0.5
    assert largest_step_deg(simulation) < 2.0, "at most 90 deg/s"


@pytest.mark.measures_time
def test_it_follows_a_stream_of_targets_within_60_ms(both: Both) -> None:
    def drive() -> None:
        pause = threading.Event()
        for step in range(150):
            angle = 20 * math.sin(step / 20)
            both.hw.move(angle, angle, angle, speed=60, wait=False)
            pause.wait(0.02)

    checked_lag(*both.record(drive))


def test_its_own_requests_are_refused_and_the_refusal_says_what_to_do(both: Both) -> None:
    requests: list[Callable[[], object]] = [lambda: both.sim.look(yaw=5), both.sim.home, both.sim.calibrate]
    for request in requests:
        with pytest.raises(Refused) as refused:
            request()
        assert refused.value.reason is Reason.FOLLOWING
        assert "--on hw" in refused.value.message
        assert "beatrix follow off" in refused.value.message
    reply = ask_raw(both.stage.client(), keys.preview("bea", "ana") + "?yaw=0.1")[0]
    assert b'"FOLLOWING"' in reply.payload


@pytest.mark.parametrize("press", [Robot.stop, Robot.disable])
def test_stop_and_switching_the_motors_off_end_following(
    both: Both, press: Callable[[Robot], object]
) -> None:
    press(both.sim)
    both.wait(FollowState.OFF)
    until(lambda: any("no longer follows" in event.message for event in both.sim.past_events()), "the event")
    both.hw.move(5, 5, 5)
    assert both.sim.positions().commanded.short == pytest.approx(0, abs=0.1)
    both.sim.reset()


def test_the_verb_switches_it_and_the_list_shows_it(both: Both) -> None:
    shell = Shell(both.stage.endpoint)
    until(lambda: "follows hw" in shell.good("ls"), "the list knows both robots")
    assert "does not follow the hardware" in shell.good("follow", "off", "--name", "bea")
    assert "follows hw" not in shell.good("ls")
    shell.good("follow", "on", "--name", "bea", "--who", "ben")
    rows = shell.json("ls")["robots"]
    assert {row["side"]: row["following"] for row in rows}["hw"] == "off"
    moved = shell.run("look", "--yaw", "5", "--name", "bea", "--on", "sim")
    assert moved.returncode == 1
    assert "beatrix follow off" in moved.stdout + moved.stderr


def test_a_program_of_2023_at_the_simulation_is_refused_and_freeze_ends_following(both: Both) -> None:
    program = Program(both.terminal)
    try:
        assert program.say("@CALNOW")[-1] == "ACK\n"  # the zero of its port only
        assert program.say("@MOVRX 20 200")[-1] == "NACK\n"
    finally:
        program.port.close()
    teacher = both.stage.robot("bea", "sim", "teacher")
    lease.ask(teacher, LeaseAction.FREEZE)
    both.wait(FollowState.OFF)
    frozen = "the teacher has frozen it"
    until(lambda: any(frozen in event.message for event in both.sim.past_events()), "the event")
    lease.ask(teacher, LeaseAction.UNFREEZE)
