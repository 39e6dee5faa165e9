"""The check of the built site finds broken links and files of other hosts."""

from __future__ import annotations

from pathlib import Path

import check_site
import pytest


@pytest.mark.parametrize(
    ("element", "fault"),
    [
        ('<a href="b.html#here">', ""),
        ('<a href="https://example.org/gone">', ""),
        ('<a href="b.html#gone">', "there is no such place in the page"),
        ('<a href="gone.html">', "there is no such file"),
        ('<img src="gone.png">', "there is no such file"),
        ('<script src="https://example.org/a.js">', "a page must work without a network"),
        ('<link href="//example.org/a.css">', "a page must work without a network"),
    ],
)
def test_a_fault_of_a_page_is_found(element: str, fault: str, tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(element, encoding="utf-8")
    (tmp_path / "b.html").write_text('<p id="here">', encoding="utf-8")
    found = list(check_site.faults(tmp_path))
    assert len(found) == bool(fault)
    assert all(fault in sentence for sentence in found)
