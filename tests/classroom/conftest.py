"""A fixture: a class without robots for the tests of a file; a file that needs more has a fixture of its own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from class_router import ClassRouter


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        yield made
