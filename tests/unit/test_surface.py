"""What programs, scripts and classes of users rely on changes only on purpose: docs/reference/stability.md."""

from __future__ import annotations

import pytest
import surface

pytestmark = pytest.mark.no_cover  # it only imports


def test_the_public_surface_is_that_of_the_file() -> None:
    found = surface.difference()
    assert not found, (
        "A line with - breaks programs of users: it needs a new major version, or keep the name. "
        "If the change is meant, run `python tools/surface.py` and commit docs/reference/surface.txt."
    )
