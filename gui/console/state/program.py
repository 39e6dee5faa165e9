"""The program so far: the requests of this window as a program that grows with the history."""

from __future__ import annotations

from pathlib import Path

from gui.console.state import code_lines, history
from gui.console.state.actions import NEW, Action, Play, SendStop, WriteFile
from gui.console.state.intents import Intent
from gui.console.state.memory import Memory, RequestRow
from gui.console.state.motions import Handles, begin
from gui.console.state.views import CodeLine, CodeView
from gui.console.state.world import World
from gui.console.texts import Texts

CONTROL = "commands"


class SaveProgram(Intent, frozen=True):
    """Write the program so far."""

    file: Path


def view(memory: Memory, world: World) -> CodeView:
    """Return the program so far."""
    made_from = (memory.rows, world.robot, world.endpoint, world.who, memory.choices.language)
    return memory.code.get(made_from, lambda: _program(memory, world))


def _program(memory: Memory, world: World) -> CodeView:
    texts = memory.choices.texts
    lines = [line for row in memory.rows for line in _lines(row, texts)]
    return CodeView(code_lines.program(lines, world, texts("code.title", robot=world.robot)))


def _lines(row: RequestRow, texts: Texts) -> list[CodeLine]:
    """Return the lines of one row; a request that did not do what was asked is a comment.

    A play that repeats always ends early, so its lines play it once.
    """
    request = row.request
    calls = [] if isinstance(request, SendStop) else code_lines.python(request, once=True).splitlines()
    if not calls and not isinstance(request, SendStop):
        return []  # it is no request to the robot of the window, or has no line of Python
    result, good = history.result(row, texts)
    repeated = isinstance(request, Play) and bool(request.again) and bool(row.accepted)
    if calls and (good is not False or repeated):
        return [CodeLine(call, row.number) for call in calls]
    first, _, _ = result.partition(". ")
    comment = " ".join(f"# {history.what(row, texts)}: {first}".split())
    return [CodeLine(comment.removesuffix("."), row.number)]


def save(memory: Memory, world: World, intent: SaveProgram) -> list[Action]:
    """Return the action that writes the program so far."""
    if not intent.file.name:
        return memory.refuse(CONTROL, "cannot.file")
    text = view(memory, world).text
    return begin(memory, world, WriteFile(NEW, intent.file, text), CONTROL)


HANDLES: Handles = {SaveProgram: save}
