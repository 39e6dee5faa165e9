"""Ctrl-C may interrupt a reader anywhere; Zenoh's thread must still enqueue publications."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from types import FrameType

import pytest

from beatrix_zenoh.bus import Received
from beatrix_zenoh.client.subscription import Inbox

CALLS = 200


def interrupted(read: Callable[[], object], nth: int) -> bool:
    """Call `read`, raise KeyboardInterrupt at its nth call or return, and return whether this happened."""
    count = 0

    def interrupt(_frame: FrameType, event: str, _arg: object) -> None:
        nonlocal count
        # Only these events are counted: CPython handles signals when a Python function begins and when a call has
        # returned, not before a C function.
        count += event in ("call", "c_return")
        if count == nth:
            sys.setprofile(None)
            raise KeyboardInterrupt

    sys.setprofile(interrupt)
    try:
        read()
    except KeyboardInterrupt:
        return True
    finally:
        sys.setprofile(None)
    return False


def publication(payload: bytes) -> Received:
    return Received("key", payload, "", None)


def test_an_interrupted_reader_does_not_block_the_next_publication() -> None:
    for nth in range(1, CALLS):
        inbox = Inbox(10)
        inbox.receive(publication(b"1"))
        was_interrupted = interrupted(lambda inbox=inbox: (inbox.next(0.0), inbox.next(0.001)), nth)  # type: ignore[misc]
        publisher = threading.Thread(target=inbox.receive, args=(publication(b"2"),), daemon=True)
        publisher.start()
        publisher.join(timeout=10.0)
        assert not publisher.is_alive(), f"interrupted at call {nth}"
        sample = inbox.next(1.0)
        assert sample is not None
        if not was_interrupted:
            assert nth > 10, "nothing was interrupted"
            return
    pytest.fail(f"more than {CALLS} calls")
