"""What the window and the page show of microphones."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gui_worlds import robot, status, world

from beatrix_zenoh.client import Presence
from beatrix_zenoh.contract._generated.messages import MicrophonesStatus
from gui.console.state.actions import WatchMicrophones
from gui.console.state.intents import Choose, Tab, TogglePage
from gui.console.state.state import State
from gui.console.state.views import LevelView
from gui.console.state.world import World


def microphones(*, on: bool) -> MicrophonesStatus:
    return MicrophonesStatus(connected=True, streaming=on, rate=48_000, source="device")


@pytest.mark.parametrize("on", [False, True])
def test_a_mark_shows_that_microphones_are_on(*, on: bool) -> None:
    """It comes before all other notes, which a narrow window leaves out first."""
    known = status("hw", microphones=microphones(on=on), limit_deg=20.0, holder="ana", lease=True)
    pill = State().view(world(hw=robot("hw", known=known))).pills[1]
    assert pill.notes[0].endswith("microphones on") == on
    assert len(pill.notes) == 1 + on


def test_microphones_are_on_only_while_their_levels_are_shown() -> None:
    state, both = State(), frozenset({"sim", "hw"})
    nothing: frozenset[str] = frozenset()
    assert not state.view(world()).sound.on, "no window begins with listening"
    assert state.handle(Choose("microphones", value=True), world()) == [], "the tab is another"
    assert state.handle(Choose("tab", Tab.EYES), world()) == [WatchMicrophones(both)]
    assert state.handle(Choose("tab", Tab.PLOTS), world()) == [WatchMicrophones(nothing)]
    state.handle(Choose("tab", Tab.EYES), world())
    teacher = replace(world(), seat="teacher")
    assert state.handle(TogglePage(), teacher)[1:] == [WatchMicrophones(nothing)]
    assert state.handle(TogglePage(), teacher)[1:] == [WatchMicrophones(both)]
    assert state.handle(Choose("microphones", value=False), world()) == [WatchMicrophones(nothing)]


def levels(now: World, *, on: bool = True) -> tuple[LevelView, ...]:
    state = State()
    state.handle(Choose("tab", Tab.EYES), now)
    state.handle(Choose("microphones", value=on), now)
    return state.view(now).sound.levels


def test_levels_are_bars_and_numbers() -> None:
    sim, hw = levels(replace(world(), levels={"sim": (-40.0, -120.0)}))
    assert (sim.left, sim.right, sim.text) == (0.5, 0.0, "left -40 dB, right -120 dB")
    assert (hw.left, hw.right, hw.text) == (0.0, 0.0, "no microphones: start the node with `--microphones`")


def test_missing_levels_have_a_reason() -> None:
    heard = world(robot("sim", known=status("sim", microphones=microphones(on=True))))
    absent = world(robot("sim", presence=Presence.ABSENT))
    for now, on, text in (
        (heard, False, "off"),
        (absent, True, "not online"),
        (heard, True, "waiting for sound"),
    ):
        assert levels(now, on=on)[0].text == text
