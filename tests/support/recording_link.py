"""A link and states that record the calls of a window under test."""

from __future__ import annotations

from gui_views import ready

from gui.console.link import Link
from gui.console.state.actions import Action
from gui.console.state.intents import Intent
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.console.state.views import View
from gui.console.state.world import World


class RecordingLink(Link):
    """Returns a given world and records actions; without threads and network."""

    def __init__(self) -> None:
        self.known: World = ready()
        self.done: list[Action] = []

    def world(self, robot: str = "") -> World:  # noqa: ARG002
        return self.known

    def do(self, action: Action) -> None:
        self.done.append(action)


class WatchedState(State):
    """The real state, which also records intents."""

    def __init__(self, saved: Saved | None = None) -> None:
        super().__init__(saved or Saved())
        self.intents: list[Intent] = []

    def handle(self, intent: Intent, world: World) -> list[Action]:
        self.intents.append(intent)
        return super().handle(intent, world)


class ShownState(State):
    """Returns a given view and records intents."""

    def __init__(self, shown: View) -> None:
        super().__init__()
        self.shown = shown
        self.intents: list[Intent] = []

    def view(self, world: World) -> View:  # noqa: ARG002
        return self.shown

    def handle(self, intent: Intent, world: World) -> list[Action]:  # noqa: ARG002
        self.intents.append(intent)
        return []
