"""Fixtures: a class without robots for the tests of a file, its server of pages, and browsers of its seats.

A file that needs more has a fixture `router` of its own.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from class_router import ClassRouter
from web_client import WebClient, serving

from beatrix_zenoh import class_words as words
from gui.page.seats import Seats


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        yield made


@pytest.fixture(scope="module")
def port(router: ClassRouter) -> Iterator[int]:
    account = router.account("teacher")
    with serving(account.connect, account=account, login=Seats(router.classroom, router.folder)) as made:
        yield made


@pytest.fixture
def browsers(port: int, router: ClassRouter) -> Iterator[dict[str, WebClient]]:
    """A browser of each seat, and one that is not logged in."""
    made = {seat: WebClient(port) for seat in ("ana", "ben", "teacher", "")}
    for seat, browser in made.items():
        browser.load()
        if seat:
            assert browser.log_in(words.read(router.folder).words[seat]).code == 303
            browser.load()
    yield made
    for browser in made.values():
        browser.__exit__()
