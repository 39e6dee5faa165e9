"""Programs of blocks, which a page sends as text: Run, End, and what became of the last one."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.state import actions, history, refusals
from gui.console.state.actions import NEW, Action, EndBlocks
from gui.console.state.intents import RunBlocks
from gui.console.state.memory import Handles, Memory, begin, lead_of
from gui.console.state.views import BlocksView, button
from gui.console.state.world import World

CONTROL = "blocks"


def view(memory: Memory, world: World) -> BlocksView:
    """Return the buttons, the present block, and the result of the last program."""
    texts = memory.choices.texts
    text, at = _result(memory)
    return BlocksView(
        run=button(texts, "blocks.run", RunBlocks(""), "" if memory.choices.sides else "off.unchecked"),
        end=button(texts, "blocks.end", EndBlocks(), "off.no_blocks" if world.block is None else ""),
        runs=world.block is not None,
        block=world.block or "",
        text=text,
        at=at,
    )


def _result(memory: Memory) -> tuple[str, str]:
    """Return the last result or refusal, and the id of the block that the refusal is about."""
    texts, refusal = memory.choices.texts, memory.refusal
    unsent = refusals.at(memory, (CONTROL,)) if refusal is not None and refusal.request is None else None
    row = next((row for row in reversed(memory.rows) if isinstance(row.request, actions.RunBlocks)), None)
    if unsent is not None or row is None:
        return ("" if unsent is None else unsent.text), ""
    for outcome in row.outcomes.values():
        if not outcome.accepted and outcome.reason not in (Reason.STOPPED, Reason.REPLACED):
            return refusals.told_by(outcome, row.sides, texts), outcome.block
    return history.result(row, texts)[0], ""


def run(memory: Memory, world: World, intent: RunBlocks) -> list[Action]:
    """Return the action that runs a program with the checked robots."""
    sides = memory.choices.sides
    return begin(
        memory, world, actions.RunBlocks(NEW, sides, intent.program, lead_of(memory, sides)), CONTROL
    )


HANDLES: Handles = {RunBlocks: run}
