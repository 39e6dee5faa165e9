"""Both robots, and a link of the window to them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from gui_links import Linked, at_home
from robots import Stage


@pytest.fixture(scope="module")
def stage(bea: Stage) -> Iterator[Stage]:
    """Both robots `bea`."""
    yield bea
    bea.close_clients()


@pytest.fixture
def linked(stage: Stage) -> Iterator[Linked]:
    """A link to both robots, which are calibrated and at home."""
    with Linked(stage.endpoint) as made:
        at_home(made)
        yield made
