"""The page of the commands has the arguments, options and help of all verbs."""

from __future__ import annotations

import commands_page
import pytest

pytestmark = pytest.mark.no_cover  # it only imports


def test_the_page_is_as_generated() -> None:
    text = commands_page.PAGE.read_text(encoding="utf-8")
    assert commands_page.page() == text, "run python tools/commands_page.py"
