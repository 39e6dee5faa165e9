"""Every path of the repository that a page names exists."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
CODE = re.compile(r"^```text\n.*?^```|`[^`\n]+`", re.MULTILINE | re.DOTALL)
"""Inline code, and drawings in text."""
PATH = re.compile(r"[\w.-]+/[\w./-]*")
FOLDERS = {path.name for path in (*ROOT.iterdir(), *(ROOT / "beatrix_zenoh").iterdir()) if path.is_dir()} - {
    "build",
    "lessons",
}
"""First parts of the paths in pages: folders of the repository, or of the library, without those that also lie elsewhere:
a pupil has a folder `lessons`, and `build` is made."""


def named(page: Path) -> set[str]:
    """Return the paths in the code and the drawings of a page, each without a colon and the text after it."""
    words = {
        word for span in CODE.findall(page.read_text(encoding="utf-8")) for word in span.strip("`").split()
    }
    return {
        word
        for word in (word.partition(":")[0] for word in words)
        if PATH.fullmatch(word) and word.split("/")[0] in FOLDERS
    }


def test_paths_of_the_pages_exist() -> None:
    missing = {
        str(page.relative_to(ROOT)): path
        for page in PAGES
        for path in sorted(named(page))
        if not (ROOT / path).exists() and not (ROOT / "beatrix_zenoh" / path).exists()
    }
    assert missing == {}
