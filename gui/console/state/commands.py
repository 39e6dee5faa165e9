"""Buttons and what they do: calibrate, home, enable, disable, reset, make ready, STOP, Record."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import Command
from gui.console.state import refusals, sending, sequence
from gui.console.state.actions import (
    Action,
    BeginRecording,
    CopyProgram,
    EndRecording,
    Govern,
    MakeReady,
    Play,
    Send,
    SendCommand,
    SendStop,
    ViewRecording,
    WriteFile,
)
from gui.console.state.intents import EmergencyStop, Intent, Repeat, RunCommand, Stop, Undo, WindowPage
from gui.console.state.memory import Memory, unreachable
from gui.console.state.motions import Handles, again, begin, pass_on, send_arms
from gui.console.state.poses import way_back
from gui.console.state.views import ButtonView, CommandsView, RecordView
from gui.console.state.world import LinkPhase, World

CONTROL, CLASS = "commands", "class"


def view(memory: Memory) -> CommandsView:
    """Return the buttons, and the refusal of one of them."""
    question = memory.choices.texts("command.disable_question") if memory.choices.hw else ""
    return CommandsView(
        calibrate=_button(memory, "calibrate", RunCommand(Command.CALIBRATE)),
        home=_button(memory, "home", RunCommand(Command.HOME)),
        enable=_button(memory, "enable", RunCommand(Command.ENABLE)),
        disable=_button(memory, "disable", RunCommand(Command.ENABLE, value=False), question),
        reset=_button(memory, "reset", RunCommand(Command.RESET)),
        undo=_undo(memory),
        refusal=refusals.at(memory, (CONTROL, sequence.CONTROL)),
    )


def stop_button(memory: Memory) -> ButtonView:
    """Return the STOP button, which is always enabled; on the page *Class* it stops all robots."""
    texts, page = memory.choices.texts, memory.choices.page
    return ButtonView(texts(f"stop.{page}"), texts(f"stop.{page}_tip"), Stop())


def emergency_button(memory: Memory) -> ButtonView:
    """Return the button of EMERGENCY_STOP, which is enabled like STOP and asks first, because heads fall."""
    texts, page = memory.choices.texts, memory.choices.page
    question = texts(f"emergency.{page}_question")
    return ButtonView(
        texts(f"emergency.{page}"), texts(f"emergency.{page}_tip"), EmergencyStop(), question=question
    )


def _button(memory: Memory, key: str, intent: Intent, question: str = "") -> ButtonView:
    texts = memory.choices.texts
    enabled = bool(memory.choices.sides)
    tooltip = texts(f"command.{key}_tip") if enabled else texts("off.unchecked")
    return ButtonView(texts(f"command.{key}"), tooltip, intent, enabled=enabled, question=question)


def _undo(memory: Memory) -> ButtonView:
    texts, found = memory.choices.texts, way_back(memory)
    if not memory.choices.sides:
        return ButtonView(texts("command.undo"), texts("off.unchecked"), Undo(), enabled=False)
    if found is None:
        return ButtonView(texts("command.undo"), texts("off.no_undo"), Undo(), enabled=False)
    tooltip = texts("command.undo_tip", **found.arms._asdict())
    if found.sides != memory.choices.sides:
        tooltip = texts("of.side", side=texts(f"side.{found.sides[0]}"), text=tooltip)
    return ButtonView(texts("command.undo"), tooltip, Undo())


def stop(memory: Memory, world: World, intent: Stop | EmergencyStop) -> list[Action]:
    """Return the action that stops both robots, or on the page *Class* all robots, even if none is online."""
    memory.live_row = sending.STOPPED
    memory.mark_dropped()
    everywhere = memory.choices.page is WindowPage.CLASS
    request = SendStop(memory.next_row(), everywhere, isinstance(intent, EmergencyStop))
    return begin(memory, world, request, CLASS if everywhere else CONTROL)


def run(memory: Memory, world: World, intent: RunCommand) -> list[Action]:
    """Return the action for a command to one robot or to the checked ones; HOME becomes a motion, with the lead."""
    if intent.command is Command.HOME:
        return send_arms(memory, world, (0.0, 0.0, 0.0), CONTROL)
    sides = (intent.side,) if intent.side else memory.choices.sides
    if unreachable(memory, world, sides, CONTROL):
        return []
    request = SendCommand(memory.next_row(), intent.command, intent.value, sides)
    return begin(memory, world, request, CONTROL)


def make_ready(memory: Memory, world: World, intent: MakeReady) -> list[Action]:
    """Return the action that enables and calibrates a robot."""
    return (
        [] if unreachable(memory, world, (intent.side,), CONTROL) else begin(memory, world, intent, CONTROL)
    )


def repeat(memory: Memory, world: World, intent: Repeat) -> list[Action]:
    """Return the request of a row as a new action: a motion for the checked robots, a command for the same robots."""
    row = memory.row(intent.row)
    if row is None:
        return memory.refuse(CONTROL, "cannot.row")
    if isinstance(row.request, SendStop):
        memory.mark_dropped()
        return begin(memory, world, again(memory, row.request), row.control)
    sides = memory.choices.sides if isinstance(row.request, Send | Play) else row.sides
    if not isinstance(row.request, WriteFile | CopyProgram | Govern) and unreachable(
        memory, world, sides, row.control
    ):
        return []
    return begin(memory, world, again(memory, row.request), row.control)


def write(memory: Memory, world: World, intent: WriteFile) -> list[Action]:
    """Return the action that writes a file of the user, for example the exported plots."""
    return (
        begin(memory, world, intent, CONTROL) if intent.file.name else memory.refuse(CONTROL, "cannot.file")
    )


def recording_view(memory: Memory, world: World) -> RecordView:
    """Return the Record button, the duration, and the button that opens the recording."""
    texts, recording = memory.choices.texts, world.recording
    if recording is not None and recording.running:
        minutes, seconds = divmod(max(0.0, recording.seconds) // 1, 60.0)
        tooltip = texts("record.ending_tip" if recording.ending else "record.end_tip")
        return RecordView(
            ButtonView(texts("record.end"), tooltip, EndRecording(), enabled=not recording.ending),
            running=True,
            text=texts("minutes", minutes=minutes, seconds=seconds),
            open=None,
        )
    shown = None
    if recording is not None:
        tooltip = texts("record.open_tip", file=str(recording.file))
        shown = ButtonView(texts("record.open"), tooltip, ViewRecording(recording.file))
    possible = world.phase is LinkPhase.ONLINE
    tooltip = texts("record.begin_tip") if possible else texts("off.no_router")
    toggle = ButtonView(texts("record.begin"), tooltip, BeginRecording(), enabled=possible)
    return RecordView(toggle, running=False, text="", open=shown)


HANDLES: Handles = {
    Stop: stop,
    EmergencyStop: stop,
    RunCommand: run,
    MakeReady: make_ready,
    Repeat: repeat,
    WriteFile: write,
    BeginRecording: pass_on,
    EndRecording: pass_on,
    ViewRecording: pass_on,
}
