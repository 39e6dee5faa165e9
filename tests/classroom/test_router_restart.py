"""`classroom init` for a new seat in the middle of a lesson: the router restarts, and nothing is lost except motions."""

from __future__ import annotations

import contextlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from class_router import ClassRouter, start_node
from patient_connections import PATIENCE_S
from robots import ready, until

from beatrix_zenoh import Robot
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated.messages import LeaseAction
from beatrix_zenoh.contract.errors import BeatrixError


def reaches(robot: Robot) -> bool:
    """Return whether a request of a seat is answered."""
    try:
        return bool(robot.status())
    except BeatrixError:
        return False


@pytest.mark.long("restarts a class")
def test_a_restart_for_a_new_seat_keeps_lease_queue_mute_and_freeze(tmp_path: Path) -> None:
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(ClassRouter(tmp_path, seats='["ana", "ben", "cleo"]'))
        node = start_node(tmp_path, router.path("bea1"))
        stack.callback(node.end)
        ana, ben, teacher = (router.robot("bea1", "hw", seat) for seat in ("ana", "ben", "teacher"))
        waiter = stack.enter_context(ThreadPoolExecutor())
        held = ready(ana).lease()
        waits = waiter.submit(ben.lease, PATIENCE_S)
        lease.ask(teacher, LeaseAction.MUTE, seat="cleo")
        lease.ask(teacher, LeaseAction.FREEZE)
        until(lambda: ana.status().waiting == ["ben"], "ben waits")

        router.rewrite('"cleo"]', '"cleo", "dora"]')
        router.process.expect("ready")
        until(lambda: all(reaches(robot) for robot in (ana, ben, teacher)), "all are connected again")
        status = router.robot("bea1", "hw", "dora").status()
        assert (status.holder, status.lease, status.waiting) == ("ana", held.number, ["ben"])
        assert (status.frozen, status.muted) == (True, ["cleo"])
        lease.ask(teacher, LeaseAction.UNFREEZE)
        ana.look(yaw=2, speed=60)
        held.close()
        assert waits.result(PATIENCE_S).number == held.number + 1
