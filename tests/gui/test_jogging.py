"""Presses of held buttons: which press an outcome ends."""

from __future__ import annotations

import queue
import time
from unittest.mock import MagicMock

from robots import until

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Interrupted
from gui.console.link.jobs import Jobs
from gui.console.link.jogging import Jogging, Press
from gui.console.state.actions import Hold, Outcome

WAIT_S = 10.0


def stop(motion: MagicMock) -> None:
    """Let a motion end, as STOP does."""
    motion.exception.return_value = Interrupted(Reason.STOPPED)
    until(lambda: motion.add_done_callback.called, "the motion is watched")
    (ended,) = motion.add_done_callback.call_args.args
    ended(motion)


def test_the_late_end_of_a_motion_does_not_end_a_press_that_has_begun_since() -> None:
    outcomes = queue.SimpleQueue[Outcome]()
    motions = [MagicMock(), MagicMock()]
    robot = MagicMock(side="hw", begin=MagicMock(side_effect=motions))
    jobs = Jobs("tested")
    jogging = Jogging(jobs, outcomes.put)
    first, second = (Press(Hold(row, "yaw", 1, 20.0, ("hw",)), (robot,)) for row in (1, 2))
    try:
        jogging.begin(first)
        assert outcomes.get(timeout=WAIT_S).row == 1
        jogging.end(stopped=True)
        jogging.begin(second)
        assert outcomes.get(timeout=WAIT_S).row == 2
        stop(motions[0])
        assert (jogging.over, jogging.busy) == (1, True)
        stop(motions[1])
        assert (jogging.over, jogging.busy) == (2, False)
    finally:
        jobs.close()
        jobs.join(time.monotonic() + WAIT_S)
