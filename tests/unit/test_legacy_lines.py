"""Lines of old programs in their queue, without a terminal or a node."""

from __future__ import annotations

from unittest.mock import Mock

import pytest

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import Text
from beatrix_zenoh.node.access import Operation
from beatrix_zenoh.node.legacy_lines import ACK, CAPACITY, LAST, NACK, LineQueue, operation_of


@pytest.mark.parametrize(
    ("text", "effect"),
    [
        (b"@MOVRX 5", Operation.MOVE),
        (b"@MOVRT 1", Operation.MOVE),
        (b"@ENMOTORS ON", Operation.ENABLE),
        (b"@ENMOTORS OFF", Operation.DISABLE),
        (b"@ENMOTORS  OFF", Operation.ENABLE),
        (b"@CALNOW", Operation.CALIBRATE),
        (b"@STOPALL", Operation.STOP),
        (b"@STOPALL ", None),
        (b"@GETXPOS", None),
    ],
)
def test_a_line_has_one_effect(text: bytes, effect: Operation | None) -> None:
    assert operation_of(text) is effect


class Port:
    """A queue with a program, a node that permits every action, and a board that answers when it is told to."""

    def __init__(self, *lines: bytes) -> None:
        self.board = Mock(connected=True, state=0, telemetry=None)
        self.driving = Mock()
        self.written = b""
        self.queue = LineQueue(self._write, self.board, self.driving)
        self.queue.program_opened()
        for line in lines:
            self.queue.take(line)

    def _write(self, data: bytes) -> None:
        self.written += data

    @property
    def sent(self) -> list[bytes]:
        """The lines that the board has received."""
        return [call.args[0] for call in self.board.send_text.call_args_list]

    @property
    def refused(self) -> list[tuple[bytes, Reason]]:
        """Lines that were recorded with an error, and its reason."""
        calls = [call.args for call in self.driving.record.call_args_list]
        return [(args[0], args[2].reason) for args in calls if len(args) > 2 and args[2] is not None]

    def answer(self, last: bytes = ACK) -> None:
        for flags, text in ((0, ACK), (LAST, last)):
            self.queue.receive(Text(flags=flags, text=text), self.queue.openings)


def test_one_line_at_a_time_is_sent_and_refusals_keep_their_place() -> None:
    port = Port(b"@MOVRX 5", b"FOO", b"@MOVRX 6")
    assert (port.sent, port.written) == ([b"@MOVRX 5"], b"")
    port.answer()
    assert (port.sent, port.written) == ([b"@MOVRX 5", b"@MOVRX 6"], ACK * 2 + NACK)
    port.answer(NACK)
    assert port.refused == [(b"@MOVRX 6", Reason.BAD_VALUE)]


def test_stop_refuses_waiting_motions_and_follows_the_other_lines() -> None:
    port = Port(b"@MOVRX 5", b"@MOVRX 6", b"@GETXPOS", b"@STOPALL")
    assert port.sent == [b"@MOVRX 5", b"@GETXPOS", b"@STOPALL"]
    assert port.refused == [(b"@MOVRX 6", Reason.STOPPED)]
    port.answer(NACK)
    assert port.written == (ACK + NACK) * 2
    assert port.refused[-1] == (b"@MOVRX 5", Reason.STOPPED)


def test_all_lines_to_a_lost_board_are_answered_and_its_return_begins_anew() -> None:
    port = Port(b"@GETXPOS", b"@MOVRX 5")
    port.queue.receive(Text(flags=0, text=ACK), port.queue.openings)
    port.board.connected, openings = False, port.queue.openings
    port.queue.observe()
    assert port.written == ACK + NACK
    assert (port.sent[-1], port.queue.openings) == (b"@MOVRX 5", openings + 1)
    port.queue.receive(Text(flags=LAST, text=ACK), openings)
    assert port.written == ACK + NACK, "an answer from before belongs to no line"


def test_a_program_that_ends_leaves_motors_off_and_no_more_than_the_capacity() -> None:
    port = Port(b"@MOVRX 5", b"@ENMOTORS OFF", *[b"@MOVRX 6"] * CAPACITY)
    port.queue.program_closed()
    port.answer()
    assert port.sent == [b"@MOVRX 5", b"@ENMOTORS OFF"]
    assert port.refused == [(b"@MOVRX 6", Reason.CLIENT_LOST)] * (CAPACITY - 2)
