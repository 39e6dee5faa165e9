"""The program so far: the requests of this window as a program that grows with the history."""

from __future__ import annotations

from pathlib import Path

from msgspec import structs

from beatrix_zenoh.client.degrees import ArmAngles, arm_angles, motion_query
from beatrix_zenoh.contract._generated.messages import MotionQuery
from gui.console.state import code_lines, history
from gui.console.state.actions import NEW, Action, Play, Send, SendStop, WriteFile
from gui.console.state.intents import Intent
from gui.console.state.memory import Memory, Request, RequestRow
from gui.console.state.motions import Handles, begin
from gui.console.state.views import CodeLine, CodeView
from gui.console.state.world import World
from gui.console.texts import Texts

CONTROL = "commands"


class SaveProgram(Intent, frozen=True):
    """Write the program so far."""

    file: Path


def view(memory: Memory, world: World) -> CodeView:
    """Return the program so far; unchanged, it comes from the cache."""
    texts, cache = memory.choices.texts, memory.code_cache
    made_from = (memory.rows, world.robot, world.endpoint, world.who, texts.code)
    if cache.made_from != made_from:
        lines = _lines(memory.rows, texts)
        cache.made_from = made_from
        cache.view = CodeView(code_lines.program(lines, world, texts("code.title", robot=world.robot)))
    return cache.view


def lines_of(row: RequestRow, texts: Texts, *, from_set_point: bool = False) -> list[CodeLine]:
    """Return the lines of one row; a request that did not do what was asked is a comment.

    A play that repeats always ends early: its whole rounds are repeated.

    from_set_point: whether the motion before it is a comment. Then a relative motion becomes an absolute one, from where
    the arms were at its request.
    """
    request = row.request
    if from_set_point:
        request = _absolute(
            request, next((row.before[side] for side in row.sides if side in row.before), None)
        )
    calls = (
        [] if isinstance(request, SendStop) else code_lines.python(request, rounds=row.rounds).splitlines()
    )
    lines = [CodeLine(call, row.number) for call in calls]
    result, good = history.result(row, texts)
    if calls and good is not False:
        return lines
    if not calls and not isinstance(request, SendStop):
        return []  # it is no request to the robot of the window, or has no line of Python
    first, _, _ = result.partition(". ")
    comment = " ".join(f"# {history.what(row, texts)}: {first}".split())
    ended = CodeLine(comment.removesuffix("."), row.number)
    return [*lines, ended] if row.rounds else [ended]


def _lines(rows: tuple[RequestRow, ...], texts: Texts) -> list[CodeLine]:
    lines: list[CodeLine] = []
    missed: set[str] = set()
    """robots whose last motion is a comment"""
    for row in rows:
        added = lines_of(row, texts, from_set_point=bool(missed & set(row.sides)))
        lines += added
        if isinstance(row.request, Send | Play):
            missed -= set(row.sides)
            missed |= {side for line in added if line.text.startswith("#") for side in row.sides}
    return lines


def _absolute(request: Request, before: ArmAngles | None) -> Request:
    """Return a relative motion of the arms as an absolute one from `before` (deg); other requests as they are."""
    if not isinstance(request, Send) or not isinstance(request.query, MotionQuery) or request.query.absolute:
        return request
    if before is None:
        return request
    way = arm_angles(request.query.position)
    goal = motion_query(
        *(start + by for start, by in zip(before, way, strict=True)), relative=False, speed=None
    )
    return structs.replace(request, query=structs.replace(goal, speed=request.query.speed))


def save(memory: Memory, world: World, intent: SaveProgram) -> list[Action]:
    """Return the action that writes the program so far."""
    if not intent.file.name:
        return memory.refuse(CONTROL, "cannot.file")
    text = view(memory, world).text
    return begin(memory, world, WriteFile(NEW, intent.file, text), CONTROL)


HANDLES: Handles = {SaveProgram: save}
