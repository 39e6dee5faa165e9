"""Check the built site: every link leads to a page and a place of it, and nothing is loaded from another host.

`make site` runs it: `python tools/check_site.py build/site`. Links to the web are not followed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = ("src", "srcset", "poster", "data")
"""Attributes whose targets a browser loads by itself; of `link` also href."""


class Page(HTMLParser):
    """The links, the loaded files and the anchors of a page."""

    def __init__(self, path: Path) -> None:
        """Read the page."""
        super().__init__()
        self.links: set[str] = set()
        self.loads: set[str] = set()
        self.anchors = {"", "top"}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Sort the attributes of an element."""
        for name, value in attrs:
            if name in ("id", "name"):
                self.anchors.add(value or "")
            elif name in LOADED or (name == "href" and tag == "link"):
                self.loads.add(value or "")
            elif name == "href":
                self.links.add(value or "")


def faults(site: Path) -> Iterator[str]:
    """Yield a sentence for each broken link and for each file of another host."""
    if not list(site.rglob("*.html")):
        yield f"{site} has no page"
    pages = {path.resolve(): Page(path) for path in site.rglob("*.html")}
    for path, page in pages.items():
        for target in sorted(page.links | page.loads):
            parts = urlsplit(target)
            if parts.scheme in ("http", "https", "mailto", "data") or parts.netloc:
                if target in page.loads and parts.scheme != "data":
                    yield f"{path.name} loads {target}: a page must work without a network"
                continue
            found = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not found.exists():
                yield f"{path.relative_to(site.resolve())}: {target}: there is no such file"
            elif found in pages and unquote(parts.fragment) not in pages[found].anchors:
                yield f"{path.relative_to(site.resolve())}: {target}: there is no such place in the page"


def main() -> int:
    """Print what is wrong, or how much is right; return 1 if anything is wrong."""
    site = Path(sys.argv[1])
    found = list(faults(site))
    print(
        "\n".join(found)
        or f"{len(list(site.rglob('*.html')))} pages, no broken link, no other host: {site}/index.html"
    )
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
