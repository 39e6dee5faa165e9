"""Connect hardware: the list of ports, what a choice starts, and a real virtual robot in a real window."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from gui_links import Linked
from gui_windows import windowed
from gui_worlds import absent, robot, world
from present import present
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from robots import Stage, free_endpoint

from beatrix_zenoh.client import Presence
from gui.console.state.actions import ConnectHardware, LookForPorts
from gui.console.state.connecting import VIRTUAL, CloseConnect
from gui.console.state.intents import Choose
from gui.console.state.state import State
from gui.console.state.world import Trouble, UsbPort, World

BOARD, CABLE = (
    UsbPort("/dev/ttyACM0", "Arduino Mega", board=True),
    UsbPort("/dev/ttyUSB1", "FT232R", board=False),
)
WITHOUT = world(hw=absent("hw"))
READY_S = 60.0
"""Time limit (s) of a child process on a busy machine."""


def opened(now: World = WITHOUT) -> State:
    state = State()
    assert state.handle(LookForPorts(), now) == [LookForPorts()]
    return state


def shown(state: State, now: World) -> tuple[str, list[str]]:
    """Return the text and the names of the ports."""
    found = present(state.view(now).connect)
    return found.text, [button.text for button in found.ports]


def test_the_list_has_boards_first_and_always_the_virtual_robot() -> None:
    assert State().view(WITHOUT).connect is None
    state = opened()
    virtual = "Virtual robot, without a cable"
    assert shown(state, WITHOUT) == ("Looking for the ports of this computer.", []), (
        "no button that will move"
    )
    text, ports = shown(state, replace(WITHOUT, ports=()))
    assert (text.partition(".")[0], ports) == ("No board was found", [virtual])
    text, ports = shown(state, replace(WITHOUT, ports=(BOARD, CABLE)))
    assert text == "Choose the board of your robot."
    assert ports == ["Robot at /dev/ttyACM0 (Arduino Mega)", "Other port /dev/ttyUSB1 (FT232R)", virtual]
    state.handle(CloseConnect(), WITHOUT)
    assert state.view(WITHOUT).connect is None


def test_a_choice_starts_the_hardware_once_and_the_list_goes_when_its_board_answers() -> None:
    state = opened()
    assert state.handle(ConnectHardware(VIRTUAL), WITHOUT) == [ConnectHardware(VIRTUAL)]
    starting = replace(WITHOUT, connecting=True, ports=(BOARD,))
    assert state.handle(ConnectHardware(VIRTUAL), starting) == []
    found = present(state.view(starting).connect)
    assert not any(button.enabled for button in (*found.ports, found.again))
    assert found.close.enabled
    state.follow(starting)
    assert state.view(starting).connect is not None
    online = world(hw=robot("hw"))
    state.follow(online)
    assert state.view(online).connect is None


def test_the_sheet_stays_beside_hardware_that_is_online_and_offers_no_second_one() -> None:
    online = world(hw=robot("hw"))
    state = State()
    assert state.handle(LookForPorts(), online) == []
    state.follow(online)
    text, ports = shown(state, online)
    assert (text, ports) == ("The hardware of bea1 is online.", [])


def test_a_failure_is_shown_in_the_language_with_the_output_as_a_detail() -> None:
    failed = replace(WITHOUT, ports=(), child_trouble=Trouble("trouble.hardware", "1", "Its output: ..."))
    state = opened()
    state.handle(Choose("language", "de"), failed)
    found = present(state.view(failed).connect)
    assert found.text == "Das Programm der Hardware ist zu Ende (1). Wähle noch einmal einen Anschluss."
    assert found.details == "Its output: ..."


@pytest.mark.usefixtures("qapp")
def test_a_virtual_robot_is_connected_with_two_presses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with windowed(free_endpoint()) as user:
        panels = user.window.panels
        user.until(panels.banner.buttons[1].isVisible, "without a router the banner offers Connect")
        user.press(panels.banner.buttons[1])
        sheet = panels.connect_sheet
        assert sheet.isVisible()
        user.until(lambda: sheet.text.text().startswith(("No board", "Choose")), "the ports were listed")
        QTest.mouseClick(panels.stop_bar, Qt.MouseButton.LeftButton)
        assert "stop" in user.last, "STOP works beside the list"
        button = next(button for button in sheet.ports if button.text().startswith("Virtual"))
        user.press(button)
        user.until(sheet.isHidden, "the virtual robot is online, and the list has gone")
        assert user.window._world.hw.presence is not Presence.ABSENT
        assert user.window._world.own_hardware


def test_a_failed_program_of_the_hardware_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BEATRIX_MICROPHONES", "file:none.wav")  # the program refuses to start
    with Stage() as stage, Linked(stage.endpoint) as linked:
        linked.do(ConnectHardware(VIRTUAL))
        world = linked.until(lambda world: not world.connecting, "it is refused", READY_S)
        assert not world.own_hardware
        trouble = present(world.child_trouble)
        assert (trouble.key, "none.wav" in trouble.detail) == ("trouble.hardware", True)
