"""A simulation that follows, apart from the hardware: wrong directions, silence, other robot files, freeze."""

from __future__ import annotations

from pathlib import Path

from old_programs import Program
from robots import Stage, until, wait_status

from beatrix_zenoh.client.request import ask
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    FollowState,
    LeaseAction,
    LeaseQuery,
    LeaseReply,
)


def govern(stage: Stage, name: str, action: LeaseAction) -> None:
    """Send a lease query of the teacher to a simulation."""
    key = keys.lease(name, "sim", "teacher")
    client = stage.client("teacher")
    assert ask(client, (name, "sim"), key, LeaseQuery(action=action), LeaseReply, 10.0).result


def test_freeze_ends_following_and_a_program_of_2023_at_the_simulation_is_refused(tmp_path: Path) -> None:
    terminal = tmp_path / "COM5"
    with Stage() as stage:
        stage.simulation("eva", "--follow", "--eyes-hz", "0", "--legacy", str(terminal))
        simulation = stage.robot("eva", "sim")
        program = Program(terminal)
        try:
            assert program.say("@CALNOW")[-1] == "ACK\n"  # the zero of its port only
            assert program.say("@MOVRX 20 200")[-1] == "NACK\n"
        finally:
            program.port.close()
        assert simulation.status().following is FollowState.WAITING
        govern(stage, "eva", LeaseAction.FREEZE)
        wait_status(simulation, lambda status: status.following is FollowState.OFF, "off")
        until(
            lambda: any("the teacher has frozen it" in event.message for event in simulation.past_events()),
            "the event",
        )
