"""A subscription to the newest publications: a flood delays no query of its session, and ends with the newest."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
from patient_connections import PATIENCE_S
from robots import Stage, until

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.bus import Bus, Incoming, Received
from beatrix_zenoh.bus.incoming import WAITING
from beatrix_zenoh.contract import codec

KEY = "beatrix/bea/sim/stop/ana"
FLOOD = 3 * WAITING


class Flooded:
    """A session whose handler of publications stands still until `go_on` is set."""

    def __init__(self, bus: Bus) -> None:
        self.received: list[str] = []
        self.go_on = threading.Event()
        self.end = bus.subscribe_newest(KEY, self._handle, lambda _key: False)
        bus.serve(KEY, self._answer)

    def _handle(self, received: Received) -> None:
        self.received.append(received.payload.decode())
        self.go_on.wait(PATIENCE_S)

    def _answer(self, incoming: Incoming) -> None:
        incoming.reply(KEY, b"answered", codec.JSON)
        incoming.finish()


@pytest.fixture(scope="module")
def sessions() -> Iterator[tuple[Bus, Bus]]:
    with Stage() as stage, zbus.connect(stage.endpoint) as one, zbus.connect(stage.endpoint) as other:
        yield one, other


def test_a_query_waits_for_no_publication_of_a_flood_and_the_newest_arrives(
    sessions: tuple[Bus, Bus],
) -> None:
    flooded, other = Flooded(sessions[0]), sessions[1]

    def put_until(text: str) -> None:
        def arrived() -> bool:
            other.put(KEY, text.encode(), codec.JSON)
            return text in flooded.received

        until(arrived, f"{text!r} has arrived")

    put_until("first")
    for number in range(FLOOD):
        other.put(KEY, str(number).encode(), codec.JSON)
    query = other.query(KEY, b"", codec.JSON)
    reply = query.next(PATIENCE_S)
    assert reply is not None
    assert set(flooded.received) == {"first"}, "the handler stands still"
    flooded.go_on.set()
    put_until("last")
    assert "0" not in flooded.received, "the oldest are dropped"
    flooded.end()


def test_a_publication_that_cannot_be_handled_does_not_end_the_subscription(
    sessions: tuple[Bus, Bus], monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[Exception] = []
    monkeypatch.setattr(threads, "show_error", shown.append)
    received: list[bytes] = []

    def handle(publication: Received) -> None:
        received.append(publication.payload)
        if len(received) == 1:
            raise ValueError

    end = sessions[0].subscribe_newest(KEY, handle, lambda _key: False)

    def arrived() -> bool:
        sessions[1].put(KEY, b"", codec.JSON)
        return len(received) > 1

    until(arrived, "the next publication has arrived")
    assert [type(error) for error in shown] == [ValueError]
    end()
