"""Callbacks on Zenoh's threads: each thread keeps its Python thread state from one message to the next."""

from __future__ import annotations

import threading

from robots import Stage, until

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Received
from beatrix_zenoh.contract import codec

KEY = "beatrix/bea/sim/state/positions"
PUBLICATIONS = 20


def test_a_thread_of_zenoh_keeps_its_thread_state() -> None:
    seen = threading.local()  # its values are part of the thread state
    first: list[int] = []
    received: list[int] = []

    def handle(_: Received) -> None:
        thread = threading.get_native_id()
        if not hasattr(seen, "before"):
            seen.before = True
            first.append(thread)
        received.append(thread)

    with Stage() as stage, zbus.connect(stage.endpoint) as one, zbus.connect(stage.endpoint) as other:
        one.subscribe(KEY, handle)

        def arrived() -> bool:
            other.put(KEY, b"", codec.JSON)
            return len(received) >= PUBLICATIONS

        until(arrived, "the publications have arrived")
    assert sorted(first) == sorted(set(received))
