"""A fixture: one simulation for all observed checks of a file."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from beatrix_zenoh.lessons.stage import Stage, open_stage


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    """A stage that observed checks share, because its start takes as long as most programs."""
    with open_stage() as stage:
        yield stage
