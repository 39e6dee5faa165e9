"""What the window and the page show of microphones."""

from __future__ import annotations

import pytest
from gui_worlds import robot, status, world

from beatrix_zenoh.contract._generated.messages import MicrophonesStatus
from gui.console.state.state import State


def microphones(*, on: bool) -> MicrophonesStatus:
    return MicrophonesStatus(connected=True, streaming=on, rate=48_000, source="device")


@pytest.mark.parametrize("on", [False, True])
def test_a_mark_shows_that_microphones_are_on(*, on: bool) -> None:
    """It comes before all other notes, which a narrow window leaves out first."""
    known = status("hw", microphones=microphones(on=on), limit_deg=20.0, holder="ana", lease=True)
    pill = State().view(world(hw=robot("hw", known=known))).pills[1]
    assert pill.notes[0].endswith("microphones on") == on
    assert len(pill.notes) == 1 + on


def test_a_robot_without_microphones_has_no_mark() -> None:
    assert not any("microphones" in note for pill in State().view(world()).pills for note in pill.notes)
