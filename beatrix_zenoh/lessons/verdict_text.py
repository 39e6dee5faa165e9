"""What `beatrix lesson check` prints: a verdict as text, and as JSON."""

from __future__ import annotations

import shutil
import textwrap

from beatrix_zenoh.lesson_files import Lesson
from beatrix_zenoh.lessons.checking import Result, Verdict
from beatrix_zenoh.lessons.progress import Record
from beatrix_zenoh.output import say

FURTHER = "Next: the last part of the page; how we did it: `beatrix lesson solution {number}`."
LABELS = {
    "en": ("Passed: {title}.", "Not yet: {title} (try {tries}).", "asked", "found", "Hint", FURTHER),
    "de": (
        "Bestanden: {title}.",
        "Noch nicht: {title} (Versuch {tries}).",
        "verlangt",
        "gefunden",
        "Hinweis",
        "Weiter: der letzte Teil der Seite; so haben wir es gelöst: `beatrix lesson solution {number}`.",
    ),
}
WIDTH = 100
"""Longest line of a hint or an explanation (characters)."""


def filled(text: str, indent: str = "") -> str:
    """Return a text in lines that fit into the terminal, each after `indent`."""
    width = min(WIDTH, shutil.get_terminal_size().columns)
    return textwrap.fill(
        " ".join(text.split()), width, initial_indent=indent, subsequent_indent=indent, break_long_words=False
    )


def document(found: Lesson, verdict: Verdict, record: Record) -> dict[str, object]:
    """Return a verdict as JSON."""
    return {
        "result": verdict.result is Result.PASSED,
        "lesson": found.name,
        "outcome": verdict.result.name.lower(),
        "figure": verdict.figure,
        "asked": verdict.asked,
        "found": verdict.found,
        "message": verdict.means,
        "hint": verdict.hint,
        "values": {
            name: value if isinstance(value, int | float | str | None) else str(value)
            for name, value in verdict.values.items()
        },
        "tries": record.tries,
    }


def show(found: Lesson, verdict: Verdict, record: Record) -> None:
    """Print a verdict for the pupil."""
    passed, not_yet, asked, wrong, hint, further = LABELS[found.language]
    if verdict.result is Result.PASSED:
        say(passed.format(title=found.title))
        say(further.format(number=found.number))
        return
    if verdict.result is Result.NOT_MEASURABLE:
        say(filled(verdict.means))
        return
    say(not_yet.format(title=found.title, tries=record.tries))
    width = max(len(asked), len(wrong))
    say(f"  {asked:<{width}}  {verdict.asked}")
    say(f"  {wrong:<{width}}  {verdict.found}")
    say(filled(verdict.means, "  "))
    if verdict.hint:
        say(f"  {hint}: beatrix lesson hint {found.number}")
