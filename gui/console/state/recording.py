"""The recording: one button starts and ends it, another opens it."""

from __future__ import annotations

from gui.console.state.actions import Action, BeginRecording, EndRecording, ViewRecording
from gui.console.state.intents import Intent, OpenRecording, ToggleRecording
from gui.console.state.memory import Memory
from gui.console.state.views import ButtonView, RecordView
from gui.console.state.world import LinkPhase, World


def view(memory: Memory, world: World) -> RecordView:
    """Return the Record button, the duration, and the button that opens the recording."""
    texts, recording = memory.choices.texts, world.recording
    if recording is not None and recording.running:
        minutes, seconds = divmod(max(0.0, recording.seconds) // 1, 60.0)
        tooltip = texts("record.ending_tip" if recording.ending else "record.end_tip")
        return RecordView(
            ButtonView(texts("record.end"), tooltip, ToggleRecording(), enabled=not recording.ending),
            running=True,
            text=texts("minutes", minutes=minutes, seconds=seconds),
            open=None,
        )
    shown = None
    if recording is not None:
        tooltip = texts("record.open_tip", file=str(recording.file))
        shown = ButtonView(texts("record.open"), tooltip, OpenRecording())
    possible = world.phase is LinkPhase.ONLINE
    tooltip = texts("record.begin_tip") if possible else texts("off.no_router")
    toggle = ButtonView(texts("record.begin"), tooltip, ToggleRecording(), enabled=possible)
    return RecordView(toggle, running=False, text="", open=shown)


def handle(world: World, intent: Intent) -> list[Action]:
    """Return the action that begins, ends or opens a recording; none if it is not possible now."""
    recording = world.recording
    if isinstance(intent, OpenRecording):
        return [] if recording is None or recording.running else [ViewRecording(recording.file)]
    if recording is None or not recording.running:
        return [BeginRecording()]
    return [] if recording.ending else [EndRecording()]
