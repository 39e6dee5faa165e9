"""The program so far: the requests of this window as a program that grows with the history."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.state import code_lines, history
from gui.console.state.actions import Action, SendStop, WriteFile
from gui.console.state.intents import Intent
from gui.console.state.memory import Memory, RequestRow
from gui.console.state.motions import begin
from gui.console.state.views import CodeLine, CodeView
from gui.console.state.world import World
from gui.console.texts import Texts

CONTROL = "commands"


class SaveProgram(Intent, frozen=True):
    """Write the program so far."""

    file: Path


@dataclass
class CodeCache:
    """The last view and what it was made from: the view is needed many times a second."""

    made_from: tuple[object, ...] = ()
    view: CodeView = field(default_factory=CodeView)


def view(memory: Memory, world: World, cache: CodeCache) -> CodeView:
    """Return the program so far; unchanged, it comes from the cache."""
    texts = memory.choices.texts
    made_from = (memory.rows, world.robot, world.endpoint, world.who, texts.code)
    if cache.made_from != made_from:
        lines = [line for row in memory.rows for line in lines_of(row, texts)]
        cache.made_from = made_from
        cache.view = CodeView(code_lines.program(lines, world, texts("code.title", robot=world.robot)))
    return cache.view


def lines_of(row: RequestRow, texts: Texts) -> list[CodeLine]:
    """Return the lines of one row; a request that did not do what was asked is a comment.

    A motion that a newer one has replaced stays a call: a relative motion counts from its goal.
    """
    calls = [] if isinstance(row.request, SendStop) else code_lines.python(row.request).splitlines()
    result, good = history.result(row, texts)
    replaced = any(outcome.reason is Reason.REPLACED for outcome in row.outcomes.values()) and row.accepted
    if calls and (good is not False or replaced):
        return [CodeLine(call, row.number) for call in calls]
    if not calls and not isinstance(row.request, SendStop):
        return []  # it is no request to the robot of the window, or has no line of Python
    first, _, _ = result.partition(". ")
    comment = " ".join(f"# {history.what(row, texts)}: {first}".split())
    return [CodeLine(comment.removesuffix("."), row.number)]


def save(memory: Memory, world: World, intent: SaveProgram, cache: CodeCache) -> list[Action]:
    """Return the action that writes the program so far."""
    if not intent.file.name:
        return memory.refuse(CONTROL, "cannot.file")
    text = view(memory, world, cache).text
    return begin(memory, world, WriteFile(memory.next_row(), intent.file, text), CONTROL)
