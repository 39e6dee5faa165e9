"""State of a Twin, from publications or, if these are old, from queries; may a seat move it; and the lag."""

from __future__ import annotations

import time
from typing import cast
from unittest.mock import Mock

import msgspec
import pytest
from statuses import AT_HOME, READY

from beatrix_zenoh import Monitor, NoAnswer, Refused, Robot
from beatrix_zenoh.client import twin_motion
from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.client.monitor import Presence, RobotState
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.client.twin_motion import MotionBegin, lag_s, stopped
from beatrix_zenoh.client.twin_state import TwinState, may_move
from beatrix_zenoh.contract._generated.messages import Fault, Positions, Reason, Status, Vector3
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.settings import Settings

OFF = msgspec.structs.replace(READY, enabled=False)
LOST = msgspec.structs.replace(READY.board, connected=False)


def positions(t_mono_ns: int = 0, short: float = 0.0) -> Positions:
    """Return positions with the short arm at `short` (rad) and the other arms at 0."""
    arms = Vector3(short, 0.0, 0.0)
    return msgspec.structs.replace(AT_HOME, t_mono_ns=t_mono_ns, position=arms, commanded=arms)


class Published:
    """A fake client, Monitor and robot, with published states and replies to queries."""

    def __init__(self, published: Status | None, queried: Status, age_s: float | None = 0.0) -> None:
        self.settings = Settings("bea", "tcp/127.0.0.1:1", "ana")
        self.replied_s: dict[tuple[str, str], float] = {}
        self.presence, self.age_s = Presence.ONLINE, age_s
        self.place, self.side = ("bea", "sim"), "sim"
        self.queries = 0
        self._published, self._queried = published, queried

    def __str__(self) -> str:
        return "bea (sim)"

    def robot(self, name: str, side: str) -> RobotState:
        return RobotState(
            robot=name,
            side=side,
            presence=self.presence,
            status=self._published,
            status_age_s=0.5,
            positions=positions(),
            positions_age_s=self.age_s,
            hz=50.0,
            events=(),
        )

    def status(self) -> Status:
        self.queries += 1
        return self._queried


def state_of(published: Published) -> TwinState:
    state = TwinState(cast("Client", published), "bea")
    state._monitor = cast("Monitor", published)
    return state


def test_a_new_published_state_needs_no_query() -> None:
    published = Published(READY, OFF)
    assert state_of(published).status(cast("Robot", published)) is READY
    assert published.queries == 0


@pytest.mark.parametrize(
    ("status", "age_s", "presence"),
    [
        (READY, 0.2, Presence.ONLINE),
        (READY, None, Presence.SILENT),
        (READY, 0.0, Presence.LOST),
        (READY, 0.0, Presence.ABSENT),
        (None, 0.0, Presence.ONLINE),
    ],
)
def test_an_old_or_missing_state_is_queried(
    status: Status | None, age_s: float | None, presence: Presence
) -> None:
    published = Published(status, OFF, age_s)
    published.presence = presence
    assert state_of(published).status(cast("Robot", published)) is OFF
    assert published.queries == 1


def test_a_state_newer_than_the_last_reply_is_awaited_or_else_queried() -> None:
    published = Published(READY, OFF)
    robot = cast("Robot", published)
    published.replied_s["bea", "sim"] = time.monotonic()
    begin_s = time.monotonic()
    assert state_of(published).status(robot) is READY  # the positions of this fake are always new
    assert time.monotonic() - begin_s >= 0.03
    published.replied_s["bea", "sim"] = time.monotonic() + 60
    assert state_of(published).status(robot) is OFF
    published.replied_s = {("bea", "hw"): time.monotonic() + 60}
    assert state_of(published).status(robot) is READY


def test_a_refusal_by_the_published_status_is_confirmed_by_a_query() -> None:
    published = Published(OFF, READY)
    state_of(published).check_may_move(cast("Robot", published))
    assert published.queries == 1
    both = Published(OFF, OFF)
    with pytest.raises(Refused, match=r"^bea \(sim\): The motors are off") as refusal:
        state_of(both).check_may_move(cast("Robot", both))
    assert refusal.value.reason is Reason.NOT_ENABLED


def test_the_motors_may_not_be_switched_if_another_seat_drives_or_the_board_is_lost() -> None:
    held = msgspec.structs.replace(READY, holder="ben", moving=True)
    published = Published(held, held)
    with pytest.raises(Refused, match=r"ben drives this robot and its motion is running"):
        state_of(published).check_may_switch(cast("Robot", published))
    lost = msgspec.structs.replace(READY, board=LOST)
    published = Published(lost, lost)
    with pytest.raises(NoAnswer):
        state_of(published).check_may_switch(cast("Robot", published))


@pytest.mark.parametrize(("holder", "who"), [("", "ana"), ("ana", "ana"), ("ben", "teacher")])
def test_the_holder_or_the_teacher_may_move_a_ready_robot(holder: str, who: str) -> None:
    may_move(msgspec.structs.replace(READY, holder=holder), who)


@pytest.mark.parametrize(
    ("change", "reason", "text"),
    [
        ({"holder": "ben"}, Reason.NOT_HOLDER, "ben drives this robot"),
        ({"holder": "ben", "lease": 3}, Reason.NOT_HOLDER, "ben has taken this robot"),
        ({"enabled": False}, Reason.NOT_ENABLED, "The motors are off"),
        ({"calibrated": False}, Reason.NOT_CALIBRATED, "Home is not known"),
        ({"enabled": False, "fault": Fault.EMERGENCY}, Reason.EMERGENCY, "EMERGENCY_STOP is latched"),
        ({"board": LOST, "fault": Fault.BOARD_LOST}, Reason.BOARD_LOST, "does not answer"),
        ({"board": LOST, "fault": Fault.CONTRACT_MISMATCH}, Reason.CONTRACT_MISMATCH, "of another version"),
        (
            {"board": LOST, "fault": Fault.BOARD_LOST, "warnings": ["The board is gone: plug it in."]},
            Reason.BOARD_LOST,
            "plug it in",
        ),
    ],
)
def test_the_first_missing_condition_is_raised(change: dict[str, object], reason: Reason, text: str) -> None:
    with pytest.raises(BeatrixError, match=text) as refusal:
        may_move(msgspec.structs.replace(READY, **change), "ana")
    assert refusal.value.reason is reason


class FakeRobot(MotionBegin):
    """A robot whose positions the test sets."""

    def __init__(self) -> None:
        self._start = ArmAngles(0.0, 0.0, 0.0)
        self._before = None
        self.begin_ns = self.delay_ns = None

    def path(self, begin_s: float, clock_s: float, delay_s: float) -> FakeRobot:
        """Process positions of a robot that turns at 1 rad/s from `begin_s` on.

        Its clock is `clock_s` ahead of ours.
        """
        for index in range(100):
            now_s = index * 0.02
            source = positions(round((now_s + clock_s) * 1e9), max(0.0, now_s - begin_s))
            self.see(Arrival(source, "bea", "sim", round((now_s + delay_s) * 1e9), 0))
        return self


@pytest.mark.parametrize("clock_s", [0.0, 7000.0, -12.0])
def test_the_lag_does_not_depend_on_the_clock_of_the_hardware(clock_s: float) -> None:
    sim = FakeRobot().path(0.111, 0.0, 0.002)
    hw = FakeRobot().path(1.234, clock_s, 0.003)
    assert lag_s(sim, hw) == pytest.approx(1.123, abs=0.003)


def test_a_robot_that_does_not_move_has_no_lag() -> None:
    assert lag_s(FakeRobot().path(0.1, 0.0, 0.0), FakeRobot().path(9.0, 0.0, 0.0)) is None
    assert lag_s(FakeRobot(), FakeRobot()) is None


def test_a_cause_that_stop_meets_again_is_reported_once(monkeypatch: pytest.MonkeyPatch) -> None:
    lost = NoAnswer(Reason.NO_ROUTER, "The router is lost.")
    pair: list[Robot] = [Mock(spec=Robot, place=("bea", side)) for side in ("sim", "hw")]
    for robot in pair:
        robot.client = Mock(**{"bus.closed": False})
    monkeypatch.setattr(twin_motion, "stop_robots", lambda robots: [(robot, lost) for robot in robots])
    named = NoAnswer(Reason.NO_ROUTER, "bea (hw): The router is lost.")
    assert str(stopped(named, pair)) == "bea (hw): The router is lost."
    other = NoAnswer(Reason.NODE_LOST, "bea (hw) is not online.")
    assert str(stopped(other, pair)) == "bea (hw) is not online.\nbea (hw): The router is lost."
    assert str(stopped(KeyboardInterrupt(), pair)) == "bea (hw): The router is lost."
