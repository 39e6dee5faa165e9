"""Who comes to a desk that has closed is answered all the same."""

from __future__ import annotations

import threading

import msgspec

from beatrix_zenoh._generated.serial import FrameType
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.answers import Asker
from beatrix_zenoh.node.node import Desk
from beatrix_zenoh.node.stop_desk import StopDesk


def test_a_question_to_a_closed_desk_is_answered_there_and_then() -> None:
    desk, done = Desk("front"), []
    desk.hand(lambda: done.append("before"))
    desk.close()
    desk.hand(lambda: done.append("after"))
    assert done == ["before", "after"]


def test_stop_is_sent_until_the_desk_closes_and_told_to_everybody() -> None:
    sent: list[FrameType] = []
    told: list[Asker | None] = []

    def tell(_road: FrameType, asker: Asker | None, error: BeatrixError | None) -> None:
        assert error is None
        told.append(asker)

    def nothing(_message: msgspec.Struct) -> None:
        """Nobody looks at the answer."""

    ana, ben = (Asker(who, "", nothing, lambda: None) for who in ("ana", "ben"))
    desk = StopDesk(sent.append, tell)
    desk.press(FrameType.STOP, ana)
    desk.close()
    desk.press(FrameType.STOP, ben)
    assert sent == [FrameType.STOP]
    assert told == [None, ana, ben]


def test_an_emergency_goes_before_a_stop_that_was_pressed_earlier() -> None:
    sent: list[FrameType] = []
    busy, pressed = threading.Event(), threading.Event()

    def send(road: FrameType) -> None:
        sent.append(road)
        busy.set()
        pressed.wait(5)

    desk = StopDesk(send, lambda *_: None)
    desk.press(FrameType.STOP, None)
    assert busy.wait(5)
    desk.press(FrameType.STOP, None)
    desk.press(FrameType.EMERGENCY_STOP, None)
    pressed.set()
    desk.close()
    assert sent == [FrameType.STOP, FrameType.EMERGENCY_STOP, FrameType.STOP]
