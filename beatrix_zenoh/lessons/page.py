"""Lessons as a browser shows them: paragraphs of text without any HTML, which the page puts into elements of its own."""

from __future__ import annotations

import re
from typing import Final, Literal

import msgspec

from beatrix_zenoh.lesson_files import BlockLesson, block_lessons

Kind = Literal["heading", "text", "item"]
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
    blocks: tuple[str, ...]
    """types of its blocks"""
    text: tuple[Paragraph, ...]


def lesson_pages(language: str) -> tuple[LessonPage, ...]:
    """Return all lessons for blocks in a language, in their order."""
    return tuple(_page(lesson) for lesson in block_lessons(language))


def _page(lesson: BlockLesson) -> LessonPage:
    text = paragraphs(lesson.page.read_text(encoding="utf-8"))
    return LessonPage(lesson.name, lesson.title, lesson.goal, tuple(lesson.about.blocks), text)


def plain(text: str) -> str:
    """Return a text on one line and without marks of Markdown."""
    return EMPHASIS.sub("", " ".join(text.split()))


def paragraphs(markdown: str) -> tuple[Paragraph, ...]:
    """Return the paragraphs of a text in Markdown below its title: headings, text, and items of lists."""
    found: list[tuple[Kind, list[str]]] = []
    goes_on = False
    for line in markdown.splitlines():
        item = ITEM.match(line)
        if line.startswith("## "):
            found.append(("heading", [line[3:]]))
        elif item:
            found.append(("item", [item[1]]))
        elif goes_on:
            found[-1][1].append(line)
        elif line and not line.startswith("#"):
            found.append(("text", [line]))
        goes_on = bool(line) and not line.startswith("#")
    return tuple(Paragraph(kind, plain(" ".join(lines))) for kind, lines in found)
