"""The lessons of the class: what each seat has reached, from the reports that the class's router keeps."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby
from typing import Final

from beatrix_zenoh.client.lesson_reports import IMPOSSIBLE, PASSED, STUCK_AT, TRYING, Row
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.lesson_files import NOT_MEASURED, asked
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts


class Progress(StrEnum):
    """What a seat has reached in a lesson; each has a symbol, a word and a colour."""

    NONE = "none"
    """the seat has not checked the lesson"""
    TRYING = TRYING
    STUCK = STUCK_AT
    """several checks in a row have found no figure that is new to the seat"""
    NOT_MEASURED = NOT_MEASURED
    """the last check could judge nothing, usually because the computer was too busy"""
    PASSED = PASSED
    IMPOSSIBLE = IMPOSSIBLE
    """no checks can have made this report"""


SHOWN: Final = {
    Progress.NONE: ("–", "lessons.none"),
    Progress.TRYING: ("○", "lessons.trying"),
    Progress.STUCK: ("▲", "lessons.stuck_at"),
    Progress.NOT_MEASURED: ("?", "lessons.not_measured"),
    Progress.PASSED: ("✓", "lessons.passed"),
    Progress.IMPOSSIBLE: ("✗", "lessons.impossible"),
}
SYMBOLS: Final = {progress: symbol for progress, (symbol, _) in SHOWN.items()}


@dataclass(frozen=True)
class LessonRowView:
    """One seat: its lesson, how many it has passed, and a mark for each lesson of the class."""

    seat: str
    cells: tuple[str, ...]
    """seat as shown, lesson, progress as symbol and words, number of passed lessons"""
    progress: Progress
    """that of the lesson in `cells`"""
    marks: tuple[Progress, ...]
    """by column of the lessons"""
    details: str
    """all lessons of the seat, for the tooltip, one a line"""


@dataclass(frozen=True)
class LessonsView:
    """What each seat has reached; the stuck ones first, then by name."""

    title: str
    """`Lessons`, with the number of seats that are stuck"""
    columns: tuple[str, ...]
    """numbers of the lessons that seats have reported, for example `03`"""
    rows: tuple[LessonRowView, ...]
    empty: str
    """why there is no row; else empty"""
    notice: str
    """why the rows may be old; empty: they are not"""


def view(world: World, texts: Texts) -> LessonsView:
    """Return what the page of the class shows about lessons; it has rows only while the page is shown."""
    reports = world.reports or ()
    columns = tuple(sorted({row.lesson[:2] for row in reports}))
    by_seat = {seat: list(rows) for seat, rows in groupby(reports, lambda row: row.seat)}
    pupils = () if world.account is None else world.account.names
    seats = {*by_seat, *((*world.seats, *pupils) if by_seat else ())} - {TEACHER}
    rows = [_row(seat, by_seat.get(seat, []), columns, world, texts) for seat in seats]
    rows.sort(key=lambda row: (row.progress is not Progress.STUCK, row.cells[0].casefold(), row.seat))
    stuck = sum(row.progress is Progress.STUCK for row in rows)
    old = world.reports_failed or world.phase is not LinkPhase.ONLINE
    return LessonsView(
        title=texts("lessons.stuck", count=float(stuck)) if stuck else texts("lessons.title"),
        columns=columns,
        rows=tuple(rows),
        empty="" if rows else _empty(world, texts),
        notice=texts("lessons.old") if rows and old else "",
    )


def _empty(world: World, texts: Texts) -> str:
    if world.phase is not LinkPhase.ONLINE:
        return texts("reason.no_router", endpoint=world.endpoint)
    if world.reports is None:
        return texts("lessons.unread" if world.reports_failed else "lessons.reading")
    return texts("lessons.empty")


def _row(
    seat: str, reports: list[Row], columns: tuple[str, ...], world: World, texts: Texts
) -> LessonRowView:
    reached = {row.lesson[:2]: Progress(row.progress) for row in reports}
    shown = _present(reports)
    progress = Progress.NONE if shown is None else Progress(shown.progress)
    passed = sum(one is Progress.PASSED for one in reached.values())
    return LessonRowView(
        seat=seat,
        cells=(
            world.shown(seat),
            "" if shown is None else shown.lesson,
            texts("lessons.none") if shown is None else _words(shown, texts),
            str(passed) if reports else "",
        ),
        progress=progress,
        marks=tuple(reached.get(number, Progress.NONE) for number in columns),
        details="\n".join(f"{row.lesson}: {_words(row, texts)}" for row in reports),
    )


def _present(reports: list[Row]) -> Row | None:
    """Return the report to show of a seat: an impossible one, else one it is stuck at, else open, else passed; the last."""
    order = (PASSED, TRYING, NOT_MEASURED, STUCK_AT, IMPOSSIBLE)
    return max(reports, key=lambda row: (order.index(row.progress), row.lesson), default=None)


def _words(row: Row, texts: Texts) -> str:
    progress, state = Progress(row.progress), row.state
    symbol, key = SHOWN[progress]
    stuck = progress is Progress.STUCK
    sentence = asked(row.lesson, state.figure, texts.code) if stuck else ""
    return f"{symbol} {texts(key, asked=sentence, count=float(state.stuck if stuck else state.tries))}"
