"""Fixtures: Qt without a display, and a window for each test with a link that only records."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator

os.environ["QT_QPA_PLATFORM"] = "offscreen"

import pytest
from gui_windows import begin_again, close_dialogs
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink, ShownState, WatchedState
from robots import Stage

from gui.console.state.intents import Intent
from gui.window.window import Window


@pytest.fixture(scope="session", autouse=True)
def runtime_folder(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Create a runtime folder if there is none, as in containers: Qt would warn, and warnings are errors."""
    os.environ.setdefault("XDG_RUNTIME_DIR", str(tmp_path_factory.mktemp("runtime")))


@pytest.fixture
def link() -> RecordingLink:
    return RecordingLink()


@pytest.fixture
def state() -> WatchedState:
    return WatchedState()


@pytest.fixture(scope="session")
def built(qapp: object) -> Window:
    """The window of all tests of this process: to build one takes longer than most tests."""
    return Window(RecordingLink(), WatchedState())


@pytest.fixture
def window(
    qtbot: QtBot, built: Window, link: RecordingLink, state: WatchedState | ShownState
) -> Iterator[Window]:
    """The window, shown and active, with the link and the state of this test; all else as at its start."""
    begin_again(built, link, state)
    qtbot.waitUntil(built.isActiveWindow)
    yield built
    close_dialogs(built)
    built.close()


@pytest.fixture
def intents(window: Window, state: WatchedState | ShownState) -> Callable[[], list[Intent]]:
    """Return a function that returns the intents since its last call, at first those after this fixture."""

    def taken() -> list[Intent]:
        given = state.intents.copy()
        state.intents.clear()
        return given

    return taken


@pytest.fixture(scope="module")
def stage(bea: Stage) -> Iterator[Stage]:
    """Both robots `bea`."""
    yield bea
    bea.close_clients()
