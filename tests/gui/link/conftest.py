"""A link of the window to both robots."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from gui_links import Linked, at_home
from robots import Stage


@pytest.fixture
def linked(stage: Stage) -> Iterator[Linked]:
    """A link to both robots, which are calibrated and at home."""
    with Linked(stage.endpoint) as made:
        at_home(made)
        yield made
