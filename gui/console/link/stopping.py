"""STOP and EMERGENCY_STOP of the window: which robots it goes to, and the outcomes of their answers."""

from __future__ import annotations

import time
from collections.abc import Callable

from beatrix_zenoh.client.stopping import Answers, StopSender
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session
from gui.console.link.outcomes import done, failed, of_several
from gui.console.state.actions import Outcome, SendStop

YIELD_S = 0.002
"""Longest time that Qt's thread yields to the thread that sends STOP."""
Report = Callable[[Outcome], None]


def send_stop(sender: StopSender, action: SendStop, session: Session, report: Report) -> None:
    """Send STOP or EMERGENCY_STOP; report an outcome for each of both robots, or one for all robots at the router.

    A side that was never online is done if the other one is known: STOP was sent to both, and there is nothing to stop.
    """
    began_s = time.monotonic()
    sim, hw = session.twin.sim.place, session.twin.hw.place
    known = [place for place in (sim, hw) if session.monitor.robot(*place).status is not None]

    def answered(answers: Answers) -> None:
        failures = {place: answer for place, answer in answers.items() if isinstance(answer, BeatrixError)}
        if action.everywhere:
            report(of_several(action.row, len(answers), failures))
            return
        for place, answer in answers.items():
            if not isinstance(answer, BeatrixError):
                report(done(action.row, place[1], answer.message, time.monotonic() - began_s))
            elif known and place not in known:
                report(done(action.row, place[1], ""))
            else:
                report(failed(action.row, place[1], answer))

    places = [("*", "*")] if action.everywhere else [hw, sim]
    expected = session.monitor.present() if action.everywhere else ()
    sender.send([session.client], places, answered, expected, YIELD_S, emergency=action.emergency)
