"""The decisions of the window: what it shows, and what an intent of the user does. Each topic has its own module."""

from __future__ import annotations

from msgspec import structs

from beatrix_zenoh.contract.names import SIDES
from gui.console.state import (
    arms,
    blocks,
    class_page,
    commands,
    connecting,
    editor,
    eyes,
    gestures,
    history,
    intents,
    leases,
    missions,
    music,
    own_gestures,
    pills,
    refusals,
    sending,
    sequence,
)
from gui.console.state.actions import Action, Outcome, Watch
from gui.console.state.intents import Choose, Intent, Tab, WindowPage
from gui.console.state.memory import Handles, Memory, pass_on
from gui.console.state.saved import Choices, Saved, changed, remembered
from gui.console.state.views import HistoryRowView, View
from gui.console.state.world import World

DEFAULTS = Saved()


def choose(memory: Memory, world: World, intent: Choose) -> list[Action]:
    """Change a choice, and return the actions that follow from it; a value that no widget reports changes nothing."""
    memory.choices = changed(memory.choices, intent.name, intent.value) or memory.choices
    if memory.choices.simple:
        memory.choices = structs.replace(memory.choices, tab=Tab.HEADS)
    refusals.hide_answered(memory, intent)
    return sending.spare_hardware(memory, world, intent)


TOPICS = (
    *(arms, blocks, class_page, commands, connecting, editor, gestures, leases),
    *(music, own_gestures, refusals, sending, sequence),
)
HANDLES: Handles = {
    Choose: choose,
    **{intent: handle for topic in TOPICS for intent, handle in topic.HANDLES.items()},
}


class State:
    """Choices and requests of the user; used in Qt's thread only."""

    def __init__(self, saved: Saved = DEFAULTS) -> None:
        """Begin with saved choices."""
        self._memory = Memory(Choices(**remembered(saved)), saved.poses, saved.music)
        self._guide = missions.Guide(saved.guided)
        self._watched: tuple[Action, ...] = (Watch(), music.SILENT)
        self._handles: Handles = {
            **HANDLES,
            **dict.fromkeys(missions.HANDLED, self._guide.handle),
        }

    @property
    def saved(self) -> Saved:
        """The choices for the next window."""
        kept = remembered(self._memory.choices)
        return Saved(**kept, poses=self._memory.poses, music=self._memory.music, guided=self._guide.done)

    @property
    def choices(self) -> Choices:
        """The present choices."""
        return self._memory.choices

    def view(self, world: World) -> View:
        """Return the present view of the window."""
        memory, texts = self._memory, self._memory.choices.texts
        banner = pills.banner(memory, world)
        return View(
            title=texts("title", robot=world.robot),
            banner=banner,
            guide=None if banner is not None else self._guide.view(memory, world),
            robots=tuple(sorted({*world.names, world.robot})),
            robot=world.robot,
            pills=tuple(pills.pill(memory, world, side) for side in SIDES),
            head=sending.head(memory, world),
            arms=arms.view(memory, world),
            sending=sending.view(memory, world),
            commands=commands.view(memory),
            gestures=gestures.view(memory, world),
            blocks=blocks.view(memory, world),
            sequence=sequence.view(memory, world),
            music=music.view(memory, world),
            eyes=eyes.view(memory, world),
            sound=eyes.sound(memory, world),
            room=eyes.room(memory, world),
            history=history.view(memory, world),
            code=editor.view(memory, world),
            record=commands.recording_view(memory, world),
            show=commands.show_view(memory, world),
            last=history.last(memory, world),
            last_detail=history.last_detail(memory, world),
            stop=commands.stop_button(memory),
            emergency=commands.emergency_button(memory),
            choices=memory.choices,
            class_page=class_page.view(memory, world),
            connect=connecting.view(memory, world),
        )

    def follow(self, world: World) -> list[Action]:
        """Show leases gained or lost since the last call, hide a refusal without a cause, and complete the row of a hold.

        Return the changes of what the window receives.
        """
        for topic in (leases, refusals, arms, connecting):
            topic.follow(self._memory, world)
        self._guide.follow(self._memory, world)
        return self._watch(world)

    def _watch(self, world: World) -> list[Action]:
        """Return what the window receives and plays, as far as it has changed since the last call."""
        found = (eyes.watched(self._memory.choices, world), music.watched(self._memory))
        before, self._watched = self._watched, found
        return [action for action in found if action not in before]

    def celebration(self, world: World) -> list[Action]:
        """Return the gesture with which the simulated head celebrates a task that was just done; usually none."""
        return self._guide.celebration(self._memory, world)

    def outcomes(self, world: World) -> tuple[tuple[HistoryRowView, ...], str]:
        """Return history and last line, the part of the view that an outcome changes."""
        return history.view(self._memory, world), history.last(self._memory, world)

    def handle(self, intent: Intent, world: World) -> list[Action]:
        """Return the actions of an intent.

        There are none if it changes only the window, or if it is refused with a reason in the view.
        """
        memory = self._memory
        if memory.choices.page is WindowPage.CLASS and isinstance(intent, intents.SendHead | intents.Undo):
            return []  # ignore their keys here, because their controls are on the other page
        handle = self._handles.get(type(intent), pass_on)
        actions = handle(memory, world, intent)  # type: ignore[arg-type]  # it is of that class
        return [*self._watch(world), *actions]

    def leave(self) -> None:
        """Forget leases, unfinished requests and a held button, because the session of this seat was closed."""
        self._memory.standings, self._memory.lease_notice, self._memory.held_row = {}, None, None
        self._memory.mark_dropped()

    def report(self, outcome: Outcome) -> None:
        """Apply the outcome of an action to history, refusal and undo list."""
        row = self._memory.row(outcome.row)
        if row is not None:
            sending.note_refusal(self._memory, outcome)
            refusals.record(self._memory, row, outcome)
            sequence.note(self._memory, row, outcome)
            self._memory.replace_row(row.after(outcome))
