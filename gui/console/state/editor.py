"""The code panel: the program of the presses until the user changes it, then a file; and its runs."""

from __future__ import annotations

from pathlib import Path

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.state import history
from gui.console.state.actions import EXAMPLES, NEW, Action, EndProgram, RunProgram, WriteProgram
from gui.console.state.intents import Intent
from gui.console.state.memory import Handles, Memory, begin
from gui.console.state.refusals import reason_of
from gui.console.state.views import CodeView, button
from gui.console.state.world import World

CONTROL = "code"


class RunCode(Intent, frozen=True):
    """Run the program in the code panel."""


def view(memory: Memory, world: World) -> CodeView:
    """Return the program, its output, and what has become of it."""
    texts, code, progress = memory.choices.texts, world.code, world.program
    file = code.file or code.presses
    text = code.text if code.file else history.code(memory, world)
    runs, ours = progress.runs(file), progress.file == file
    message, failed = _message(memory, world, file)
    return CodeView(
        text=text,
        opens=code.opens,
        title=code.file.name if code.file else texts("code.presses"),
        file=code.file,
        folder=code.presses.parent,
        run=button(texts, "code.end", EndProgram()) if runs else button(texts, "code.run", RunCode()),
        message=message,
        failed=failed,
        output=progress.output if ours else (),
        line=progress.line if ours and failed else 0,
    )


def _message(memory: Memory, world: World, file: Path) -> tuple[str, bool]:
    """Return what has become of the program, or what to do; and whether it has failed."""
    texts, code, progress = memory.choices.texts, world.code, world.program
    if code.trouble is not None:
        return texts(code.trouble.key, **code.trouble.slots), True
    if progress.runs(file):
        return texts("code.running"), False
    row = next((row for row in reversed(memory.rows) if row.control == CONTROL), None)
    if row is None or not isinstance(row.request, RunProgram) or row.request.file != file:
        shipped = file.is_relative_to(EXAMPLES)
        return texts("code.shipped" if shipped else "code.saved" if code.file else "code.grows"), False
    text, _ = history.result(row, texts)
    bad = [outcome for outcome in row.outcomes.values() if not outcome.accepted]
    if bad and not row.dropped and bad[0].reason is not Reason.REPLACED:
        text = reason_of(bad[0], texts)
        return texts("code.at_line", line=progress.line, text=text) if progress.line else text, True
    return text[:1].upper() + text[1:], False


def run(memory: Memory, world: World, _intent: RunCode) -> list[Action]:
    """Return the actions that run the program; that of the presses is written before."""
    code = world.code
    write = [] if code.file else [WriteProgram(history.code(memory, world), code.presses)]
    return [*write, *begin(memory, world, RunProgram(NEW, code.file or code.presses), CONTROL)]


HANDLES: Handles = {RunCode: run}
