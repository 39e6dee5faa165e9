"""What the teacher has decided outlives a restart of the robot's node; mute and the end of a turn on a robot."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from robots import Stage, ready, until

from beatrix_zenoh import Interrupted, Robot
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated.messages import Fault, LeaseAction, Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import OLD_PROGRAMS


class Place:
    """A robot whose node can be restarted, and robots of several seats."""

    def __init__(self, stage: Stage, folder: Path) -> None:
        self.stage, self.folder = stage, folder
        self.start()
        self.boss, self.ana, self.ben = (stage.robot("bea", "hw", who) for who in ("teacher", "ana", "ben"))

    @property
    def file(self) -> Path:
        return self.folder / "robots" / "bea.hw.toml"

    def start(self) -> None:
        """Start a node with a new board."""
        self.stage.node("bea", kept=self.folder / "robots")

    def restart(self) -> None:
        """Close the node and start another one with a new board."""
        self.stage.end_nodes()
        self.start()

    def refused(self, request: Callable[[], object]) -> Reason:
        """Return the reason of a refused request."""
        with pytest.raises(BeatrixError) as refused:
            request()
        return refused.value.reason


@pytest.fixture
def kept(tmp_path: Path) -> Iterator[Place]:
    with Stage() as stage:
        yield Place(stage, tmp_path)


def test_freeze_limit_and_mute_outlive_a_restart_until_the_teacher_lifts_them(kept: Place) -> None:
    assert not kept.file.exists()
    lease.ask(kept.boss, LeaseAction.FREEZE)
    lease.ask(kept.boss, LeaseAction.LIMIT, lease.limit_of(20))
    lease.ask(kept.boss, LeaseAction.MUTE, seat="ben")
    kept.restart()
    status = kept.ana.status()
    assert (status.frozen, status.muted) == (True, ["ben"])
    assert status.speed_limit == pytest.approx(math.radians(20))
    assert kept.refused(kept.ana.enable) is Reason.FROZEN
    assert kept.refused(kept.ben.enable) is Reason.MUTED
    lease.ask(kept.boss, LeaseAction.UNFREEZE)
    lease.ask(kept.boss, LeaseAction.LIMIT)
    assert kept.file.read_text() == 'muted = ["ben"]\n'
    lease.ask(kept.boss, LeaseAction.UNMUTE, seat="ben")
    assert not kept.file.exists()
    kept.restart()
    kept.ana.enable()


def test_an_emergency_stop_of_the_teacher_is_the_teachers_to_reset_also_after_a_restart(kept: Place) -> None:
    ready(kept.ana)
    kept.boss.emergency_stop()
    for restarted in (False, True):
        if restarted:
            kept.restart()  # the new board is not latched
        status = kept.ana.status()
        assert (status.fault, status.teacher_latch) == (Fault.EMERGENCY, True)
        assert kept.refused(kept.ana.reset) is Reason.TEACHER_ONLY
        assert kept.refused(kept.ana.enable) is Reason.EMERGENCY
    kept.boss.reset()
    assert not kept.file.exists()
    kept.ana.enable()


BROKEN = (
    "frozen = maybe",
    "frozen = 3\n",
    "",
    "speed_limit_deg_s = -1\n",
    "x = 1\n",
    'muted = ["teacher"]\n',
)


def test_a_broken_file_freezes_the_robot_with_a_sentence_and_unfreeze_mends_it(kept: Place) -> None:
    for content in BROKEN:
        lease.ask(kept.boss, LeaseAction.FREEZE)
        kept.file.write_text(content)
        kept.restart()
        status = kept.ana.status()
        assert status.frozen, content
        assert any("beatrix unfreeze" in warning and str(kept.file) in warning for warning in status.warnings)
        lease.ask(kept.boss, LeaseAction.UNFREEZE)
        assert not kept.file.exists(), content
        kept.ana.enable()


def test_a_decision_that_cannot_be_kept_is_in_force_with_a_warning(kept: Place) -> None:
    (kept.folder / "robots").write_text("a file in place of the folder")
    lease.ask(kept.boss, LeaseAction.FREEZE)
    status = kept.ana.status()
    assert status.frozen
    assert any("a restart of this robot's program ends it" in warning for warning in status.warnings)


def test_mute_stops_the_motion_of_the_seat_and_the_next_one_gets_the_robot(kept: Place) -> None:
    ready(kept.ana)
    held = kept.ana.lease()
    motion = kept.ana.look(yaw=60, speed=20, wait=False)
    until(lambda: kept.ana.positions().commanded.short > 1, "moving")
    lease.ask(kept.ben, LeaseAction.WAIT)
    lease.ask(kept.boss, LeaseAction.MUTE, seat="ana")
    with pytest.raises(Interrupted, match="has muted this seat"):
        motion.wait()
    assert kept.ben.status().holder == "ben"
    for request in (kept.ana.home, kept.ana.lease):
        assert kept.refused(request) is Reason.MUTED
    assert kept.ana.positions().commanded is not None, "a muted seat still watches"
    held.close()


def test_only_the_teacher_mutes_and_neither_itself_nor_invalid_seats(kept: Place) -> None:
    def mute(robot: Robot, seat: str) -> Reason:
        return kept.refused(lambda: lease.ask(robot, LeaseAction.MUTE, seat=seat))

    for seat in ("teacher", "Ana", "", OLD_PROGRAMS):
        assert mute(kept.boss, seat) is Reason.BAD_VALUE, seat
    assert mute(kept.ana, "ben") is Reason.TEACHER_ONLY
    assert kept.boss.status().muted == []
