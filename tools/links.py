"""Check that the target of every link in the markdown pages exists: `python tools/links.py`."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^()\s]+)\)")
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def pages() -> list[Path]:
    """Return all markdown pages in the top folder and in docs."""
    return [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]


def prose(page: Path) -> str:
    """Return the text of a page without its code blocks."""
    return FENCED.sub("", page.read_text(encoding="utf-8"))


def anchors(page: Path) -> set[str]:
    """Return the anchors that GitHub gives to the headings of a page."""
    headings = HEADING.findall(prose(page))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def broken_links(page: Path) -> Iterator[str]:
    """Yield a message for each link of a page whose target does not exist; links to the web are not checked."""
    for target in LINK.findall(prose(page)):
        if "://" in target or target.startswith("mailto:"):
            continue
        path, _, fragment = target.partition("#")
        target_path = page.parent / path if path else page
        if not target_path.exists():
            yield f"{page.relative_to(ROOT)}: {target}: there is no such file"
        elif fragment and target_path.suffix == ".md" and fragment not in anchors(target_path):
            yield f"{page.relative_to(ROOT)}: {target}: there is no such heading"


def main() -> int:
    """Print the broken links; return 1 if there are any."""
    broken = [line for page in sorted(pages()) for line in broken_links(page)]
    for line in broken:
        print(line)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
