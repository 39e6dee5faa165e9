"""A publication that several threads ask whether a client subscribes: none gets an answer older than the last change."""

from __future__ import annotations

import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import cast

import zenoh

from beatrix_zenoh.bus.declarations import Publication

PATIENCE_S = 5.0


class SlowPublisher:
    """A publisher of Zenoh which answers about subscribers when `release` is set."""

    def __init__(self) -> None:
        self.asked, self.release = threading.Event(), threading.Event()
        self.changed: Callable[[zenoh.MatchingStatus | None], None] = lambda _: None
        self.matching = False

    def declare_matching_listener(self, listener: Callable[[zenoh.MatchingStatus | None], None]) -> None:
        self.changed = listener

    @property
    def matching_status(self) -> SimpleNamespace:
        self.asked.set()
        assert self.release.wait(PATIENCE_S)
        return SimpleNamespace(matching=self.matching)


def test_a_thread_woken_by_a_subscriber_does_not_get_the_answer_from_before() -> None:
    """As the status asks and the eyes are woken: with the old answer they would sleep on for ten seconds."""
    publisher, woken = SlowPublisher(), threading.Event()
    publication = Publication("beatrix/bea1/sim/camera/left", "image/jpeg", woken.set)
    session = SimpleNamespace(declare_publisher=lambda *_, **__: publisher)
    publication.declare(cast("zenoh.Session", session))
    publisher.release.set()
    assert not publication.subscribed
    publisher.release.clear()
    publisher.asked.clear()
    woken.clear()

    publisher.matching = True
    publisher.changed(None)
    status = threading.Thread(target=lambda: publication.subscribed, daemon=True)
    status.start()
    assert publisher.asked.wait(PATIENCE_S)
    assert woken.is_set()
    answers: list[bool] = []
    eyes = threading.Thread(target=lambda: answers.append(publication.subscribed), daemon=True)
    eyes.start()
    eyes.join(0.05)  # long enough for a cached answer
    publisher.release.set()
    for thread in (status, eyes):
        thread.join(PATIENCE_S)
    assert answers == [True]
