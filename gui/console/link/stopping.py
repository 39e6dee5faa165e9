"""STOP of the window: which robots it goes to, and the outcomes of their answers."""

from __future__ import annotations

import time
from collections.abc import Callable

from beatrix_zenoh.client.stopping import Answers, StopSender
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session
from gui.console.link.outcomes import done, failed, of_several
from gui.console.state.actions import Outcome

YIELD_S = 0.002
"""Longest time that Qt's thread yields to the thread that sends STOP."""
Report = Callable[[Outcome], None]


def stop_both(sender: StopSender, session: Session, row: int, report: Report) -> None:
    """Send STOP to hardware and simulation; report an outcome for each."""
    began_s = time.monotonic()

    def answered(answers: Answers) -> None:
        for (_, side), answer in answers.items():
            if isinstance(answer, BeatrixError):
                report(failed(row, side, answer))
            else:
                report(done(row, side, answer.message, time.monotonic() - began_s))

    twin = session.twin
    sender.send([session.client], [twin.hw.place, twin.sim.place], answered, yield_s=YIELD_S)


def stop_all(sender: StopSender, session: Session, row: int, report: Report) -> None:
    """Send STOP to all robots at the router; report one outcome."""

    def answered(answers: Answers) -> None:
        failures = {place: answer for place, answer in answers.items() if isinstance(answer, BeatrixError)}
        report(of_several(row, len(answers), failures))

    sender.send([session.client], [("*", "*")], answered, session.monitor.present(), YIELD_S)
