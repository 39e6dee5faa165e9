"""Lessons as a browser shows them: paragraphs of text without any HTML, which the page puts into elements of its own."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, Literal

import msgspec

from beatrix_zenoh.lesson_files import BlockLesson, block_lessons

Kind = Literal["heading", "text", "item", "code"]
EMPHASIS: Final = re.compile(r"\*\*|`|(?<!\w)\*(?=\w)|(?<=[\w.!?])\*(?!\w)")
"""Marks of Markdown inside a line; a page of blocks has no other ones."""
ITEM: Final = re.compile(r"(?:\*|-|\d+\.) +(.*)")


class Paragraph(msgspec.Struct, frozen=True):
    """A paragraph of a lesson's text."""

    kind: Kind
    text: str


class LessonPage(msgspec.Struct, frozen=True):
    """A lesson for blocks, without its hints, which are given one after the other."""

    name: str
    title: str
    goal: str
    minutes: int
    blocks: tuple[str, ...]
    """types of its blocks"""
    text: tuple[Paragraph, ...]


@cache
def lesson_pages(language: str) -> tuple[LessonPage, ...]:
    """Return all lessons for blocks in a language, in their order."""
    return tuple(_page(lesson) for lesson in block_lessons(language))


def _page(lesson: BlockLesson) -> LessonPage:
    about = lesson.about
    text = paragraphs(lesson.page.read_text(encoding="utf-8"))
    return LessonPage(lesson.name, lesson.title, lesson.goal, about.minutes, tuple(about.blocks), text)


def paragraphs(markdown: str) -> tuple[Paragraph, ...]:
    """Return the paragraphs of a text in Markdown below its title: headings, text, items of lists, and code."""
    found: list[tuple[Kind, list[str]]] = []
    fenced = again = False
    for line in markdown.splitlines():
        fence, item = line.startswith("```"), ITEM.match(line)
        if fence:
            fenced = not fenced
            found += [("code", [])] if fenced else []
        elif fenced:
            found[-1][1].append(line)
        elif line.startswith("## "):
            found.append(("heading", [line[3:]]))
        elif item:
            found.append(("item", [item[1]]))
        elif line and not line.startswith("# "):
            if again:
                found[-1][1].append(line.strip())
            else:
                found.append(("text", [line]))
        again = bool(line) and not fence and not line.startswith("#")
    return tuple(
        Paragraph(kind, "\n".join(lines) if kind == "code" else EMPHASIS.sub("", " ".join(lines)))
        for kind, lines in found
    )
