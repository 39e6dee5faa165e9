"""What status shows for a while."""

from __future__ import annotations

import time

import pytest

from beatrix_zenoh.node.notices import RESTARTED, Notices


def test_a_sentence_is_shown_once() -> None:
    notices = Notices()
    for text in ("one", "two", "one"):
        notices.add(text)
    assert notices.recent() == ["two", "one"]


def test_a_restart_is_told_until_home_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    notices = Notices()
    notices.started(1, home_known=True)
    assert notices.recent() == []
    notices.started(2, home_known=False)
    notices.add("something else")
    notices.started(2, home_known=False)
    assert notices.recent() == [RESTARTED, "something else"]
    later = time.monotonic() + 3600
    monkeypatch.setattr(time, "monotonic", lambda: later)
    assert notices.recent() == [RESTARTED]
    notices.started(2, home_known=True)
    assert notices.recent() == []
    notices.started(2, home_known=False)
    assert notices.recent() == []
