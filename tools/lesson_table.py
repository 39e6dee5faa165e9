"""Write the tables of docs/lessons/README.md from the lessons themselves: `python tools/lesson_table.py`.

A test checks that the page is up to date.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from beatrix_zenoh import lesson_files
from beatrix_zenoh.lesson_files import Lesson

PAGE: Final = Path(__file__).resolve().parent.parent / "docs/lessons/README.md"
BLOCK: Final = re.compile(r"(<!-- begin (\w+)[^>]*-->\n).*?(<!-- end -->)", re.DOTALL)
LEVELS: Final = {"S": "school", "U": "university", "S/U": "both"}
TIME: Final = re.compile(r"Time: (\d+) minutes")


def links(lesson: Lesson, files: dict[str, str]) -> str:
    """Return links to those of these files that the lesson has; `files` has the word of each."""
    folder = f"../../{lesson.folder.relative_to(PAGE.parents[2]).as_posix()}"
    return ", ".join(
        f"[{word}]({folder}/{file})" for file, word in files.items() if (lesson.folder / file).is_file()
    )


def python_rows() -> Iterator[str]:
    """Yield the lines of the table of lessons in Python."""
    yield "| | lesson | minutes | for | more |\n|---|---|---|---|---|\n"
    for one in lesson_files.lessons():
        about, title = one.about, links(one, {"lesson.md": one.title})
        more = links(
            one,
            {
                "teacher.md": "teacher",
                "start.py": "program",
                "lesson.de.md": "Deutsch",
                "teacher.de.md": "Lehrkraft",
            },
        )
        needs = f" Needs {', '.join(about.needs)}." if about.needs else ""
        yield f"| {one.number} | {title}: {one.goal}{needs} | {about.minutes} | {LEVELS[about.level]} | {more} |\n"


def block_rows() -> Iterator[str]:
    """Yield the lines of the table of lessons with blocks."""
    yield "| lesson | minutes | more |\n|---|---|---|\n"
    for one in lesson_files.block_lessons():
        minutes = TIME.search(one.page.read_text(encoding="utf-8"))
        german = one.page.with_suffix(".de.md").name
        more = links(one, {german: "Deutsch", "teacher.md": "teacher", "teacher.de.md": "Lehrkraft"})
        yield f"| {links(one, {one.page.name: one.title})}: {one.goal} | {minutes[1] if minutes else ''} | {more} |\n"


def page(text: str) -> str:
    """Return the text of a page with new generated blocks."""
    blocks = {"python": python_rows, "blocks": block_rows}
    return BLOCK.sub(lambda found: found[1] + "".join(blocks[found[2]]()) + found[3], text)


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
