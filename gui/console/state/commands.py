"""Buttons and what they do: calibrate, home, undo, enable, disable, reset, make ready, STOP, Record, Photo, Film."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.contract._generated.messages import Command
from gui.console.state import actions, refusals, sending, sequence
from gui.console.state.actions import NEW, Action, MakeReady, SendCommand, SendStop, TakePicture, WriteFile
from gui.console.state.intents import EmergencyStop, Intent, Repeat, RunCommand, Stop, Undo, WindowPage
from gui.console.state.memory import Handles, Memory, Request, RequestRow, again, begin, send_arms
from gui.console.state.views import ButtonView, CommandsView, RecordView, ShowView, button
from gui.console.state.world import LinkPhase, World, news, reading
from gui.console.texts import Texts

CONTROL, CLASS = "commands", "class"
DAILY = ("home", "undo")
"""Commands of every day, large buttons of the window; the menus of the pills contain the others."""


def view(memory: Memory) -> CommandsView:
    """Return the buttons, and the refusal of one of them."""
    question = memory.choices.texts("command.disable_question") if memory.choices.hw else ""
    buttons = {
        "home": _button(memory, "home", RunCommand(Command.HOME)),
        "undo": _undo(memory),
        "enable": _button(memory, "enable", RunCommand(Command.ENABLE)),
        "calibrate": _button(memory, "calibrate", RunCommand(Command.CALIBRATE)),
        "disable": _button(memory, "disable", RunCommand(Command.ENABLE, value=False), question),
        "reset": _button(memory, "reset", RunCommand(Command.RESET)),
    }
    return CommandsView(buttons, refusals.at(memory, (CONTROL, sequence.CONTROL)))


def stop_button(memory: Memory) -> ButtonView:
    """Return the STOP button, which is always enabled; on the page *Class* it stops all robots."""
    return button(memory.choices.texts, f"stop.{memory.choices.page}", Stop())


def emergency_button(memory: Memory) -> ButtonView:
    """Return the button of EMERGENCY_STOP, which is enabled like STOP and asks first, because heads fall."""
    texts, page = memory.choices.texts, memory.choices.page
    question = texts(f"emergency.{page}_question")
    return button(texts, f"emergency.{page}", EmergencyStop(), question=question)


def _button(memory: Memory, key: str, intent: Intent, question: str = "") -> ButtonView:
    off = "" if memory.choices.sides else "off.unchecked"
    return button(memory.choices.texts, f"command.{key}", intent, off, question=question)


def _undo(memory: Memory) -> ButtonView:
    texts, found = memory.choices.texts, way_back(memory)
    if not memory.choices.sides or found is None:
        off = "off.no_undo" if memory.choices.sides else "off.unchecked"
        return button(texts, "command.undo", Undo(), off)
    tooltip = texts("command.undo_tip", **found.arms._asdict())
    if found.sides != memory.choices.sides:
        tooltip = texts("of.side", side=texts(f"side.{found.sides[0]}"), text=tooltip)
    return ButtonView(texts("command.undo"), tooltip, Undo())


def stop(memory: Memory, world: World, intent: Stop | EmergencyStop) -> list[Action]:
    """Return the action that stops both robots, or on the page *Class* all robots, even if none is online."""
    memory.live_row = sending.STOPPED
    memory.mark_dropped()
    everywhere = memory.choices.page is WindowPage.CLASS
    request = SendStop(NEW, everywhere, isinstance(intent, EmergencyStop))
    return begin(memory, world, request, CLASS if everywhere else CONTROL)


def run(memory: Memory, world: World, intent: RunCommand) -> list[Action]:
    """Return the action for a command to one robot or to the checked ones; HOME becomes a motion, with the lead."""
    if intent.command is Command.HOME:
        return send_arms(memory, world, (0.0, 0.0, 0.0), CONTROL)
    sides = (intent.side,) if intent.side else memory.choices.sides
    request = SendCommand(NEW, intent.command, intent.value, sides)
    return begin(memory, world, request, CONTROL)


def request(memory: Memory, world: World, intent: MakeReady | WriteFile) -> list[Action]:
    """Return the action that makes a robot ready, or writes a file of the user, for example the exported plots."""
    return begin(memory, world, intent, CONTROL)


def repeat(memory: Memory, world: World, intent: Repeat) -> list[Action]:
    """Return the request of a row as a new action: a motion for the checked robots, a command for the same robots."""
    row = memory.row(intent.row)
    if row is None:
        return memory.refuse(CONTROL, "cannot.row")
    if isinstance(row.request, SendStop):
        memory.mark_dropped()
    return begin(memory, world, again(memory, row.request), row.control)


class WayBack(NamedTuple):
    """What *Undo* does now."""

    row: RequestRow
    """the motion that it undoes"""
    sides: tuple[str, ...]
    """the checked robots that made that motion"""
    arms: ArmAngles
    """where they go (deg): the arms before that motion"""


def way_back(memory: Memory) -> WayBack | None:
    """Return how the newest motion of a checked robot is undone; None if there is none.

    Robots that did not make the motion stay where they are. If both made it from different places, both go to that of
    the hardware: it gets no pose that only the simulation had, and both go there with preview and lead. Angles are
    counted from home, so nothing is undone that is older than a request that may have changed home.
    """
    for row in reversed(memory.rows):
        if row.accepted and sets_home(row.request):
            return None
        sides = tuple(side for side in memory.choices.sides if side in row.before)
        if row.accepted and not row.undoes and sides:
            return WayBack(row, sides, row.before[sides[-1]])
    return None


def undo(memory: Memory, world: World, _intent: Undo) -> list[Action]:
    """Return the action that turns the arms back to their angles before the last accepted motion."""
    found = way_back(memory)
    if found is None:
        return memory.refuse(CONTROL, "off.no_undo")
    begun = send_arms(memory, world, found.arms, CONTROL, undoes=True, sides=found.sides)
    if begun:  # so that each robot goes further back at the next press
        rest = {side: arms for side, arms in found.row.before.items() if side not in found.sides}
        memory.replace_row(replace(found.row, before=rest))
    return begun


def sets_home(request: Request) -> bool:
    """Return whether a request may change home, the position from which arm angles are counted."""
    commands = (Command.ENABLE, Command.CALIBRATE)
    return isinstance(request, MakeReady) or (
        isinstance(request, SendCommand) and request.command in commands
    )


def recording_view(memory: Memory, world: World) -> RecordView:
    """Return the Record button, the duration, and the button that opens the recording."""
    texts, recording = memory.choices.texts, world.recording
    if recording is not None and recording.running:
        off = "record.ending_tip" if recording.ending else ""
        toggle = button(texts, "record.end", actions.EndRecording(), off)
        return RecordView(toggle, _clock(texts, recording.seconds))
    shown = None
    if recording is not None:
        shown = button(texts, "record.open", actions.ViewRecording(recording.file), file=str(recording.file))
    off = "" if world.phase is LinkPhase.ONLINE else "off.no_router"
    return RecordView(button(texts, "record.begin", actions.BeginRecording(), off), open=shown)


def _clock(texts: Texts, seconds: float) -> str:
    minutes, seconds = divmod(max(0.0, seconds) // 1, 60.0)
    return texts("minutes", minutes=minutes, seconds=seconds)


def show_view(memory: Memory, world: World) -> ShowView:
    """Return *Photo* and *Film*; they show the checked robots, or the only one whose pose is known."""
    texts, picture = memory.choices.texts, world.picture
    known = [side for side in ("sim", "hw") if reading(world, side) is not None]
    sides = tuple(side for side in known if side in memory.choices.sides) or tuple(known)
    titles = tuple(texts(f"side.{side}") for side in sides) if len(sides) > 1 else ("",)
    caption = f"{world.shown(world.seat)} · {world.robot}"
    photo, film = (TakePicture(film, sides, titles, caption) for film in (False, True))
    if picture.seconds is not None:
        end, busy = button(texts, "picture.film_end", actions.EndFilm()), "picture.film_end_tip"
        record = RecordView(end, _clock(texts, picture.seconds))
        return ShowView(button(texts, "picture.photo", photo, busy), record)
    off = "picture.writing_tip" if picture.writing else "" if sides else "off.no_position"
    shown = None
    if picture.file is not None:
        shown = button(texts, "picture.open", actions.OpenPicture(picture.file), file=str(picture.file))
    toggle = button(texts, "picture.writing" if picture.writing else "picture.film", film, off)
    return ShowView(button(texts, "picture.photo", photo, off), RecordView(toggle, open=shown))


def take_picture(memory: Memory, world: World, action: TakePicture) -> list[Action]:
    """Return the action; its file will be the news of the last line."""
    memory.news = news(world)
    return [action]


HANDLES: Handles = {
    Stop: stop,
    EmergencyStop: stop,
    RunCommand: run,
    MakeReady: request,
    Repeat: repeat,
    Undo: undo,
    WriteFile: request,
    TakePicture: take_picture,
}
