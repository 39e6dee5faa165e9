"""Lines of old programs in their queue, without a terminal or a node."""

from __future__ import annotations

from unittest.mock import Mock

import pytest

from beatrix_zenoh.contract._generated.messages import Phase, Reason
from beatrix_zenoh.contract._generated.serial import Text
from beatrix_zenoh.legacy import Effect
from beatrix_zenoh.legacy.line import ACK, NACK, Answer, ProgramLine, effect_of
from beatrix_zenoh.legacy.link import TextLink
from beatrix_zenoh.legacy.outcomes import explain, misread
from beatrix_zenoh.legacy.port import CAPACITY, LAST, LineQueue


@pytest.mark.parametrize(
    ("text", "effect"),
    [
        (b"@MOVRX 5", Effect.MOVE),
        (b"@MOVHOME", Effect.MOVE),
        (b"@MOVRT 1", Effect.MOVE),
        (b"@ENMOTORS ON", Effect.ENABLE),
        (b"@ENMOTORS", Effect.ENABLE),
        (b"@ENMOTORS OFF", Effect.DISABLE),
        (b"@ENMOTORS OFF 1", Effect.DISABLE),
        (b"@ENMOTORS  OFF", Effect.ENABLE),
        (b"@CALNOW", Effect.CALIBRATE),
        (b"@CALNOW 5", Effect.NONE),
        (b"@STOPALL", Effect.STOP),
        (b"@STOPALL ", Effect.NONE),
        (b"@GETXPOS", Effect.NONE),
        (b"", Effect.NONE),
    ],
)
def test_a_line_has_one_effect(text: bytes, effect: Effect) -> None:
    assert effect_of(text) is effect


@pytest.mark.parametrize(
    ("text", "unknown", "word"),
    [
        (b"@MOVRX", True, "does not understand `@MOVRX`"),
        (b"@MOVTORPOS 20000 20000", False, "32767"),
        (b"@MOVAALL 1 -40000 2", False, "32767"),
        (b"@MOVAALL 1 2 3 40000", False, ""),
        (b"@MOVRX abc", False, ""),
        (b"@ENMOTORS ON", False, ""),
        (b"@FOO", True, ""),
    ],
)
def test_the_cause_of_a_refusal_is_found_in_the_line_itself(text: bytes, unknown: bool, word: str) -> None:
    cause = explain(ProgramLine(text), unknown=unknown)
    assert (cause is not None) == bool(word)
    if cause is not None:
        assert cause.reason is Reason.BAD_VALUE
        assert word in cause.message


@pytest.mark.parametrize(
    ("text", "read"),
    [
        (b"@MOVRX None", "`None` is no number and counts as 0."),
        (b"@MOVAX np.float64(20.0) 200", "`np.float64(20.0)` is no number and counts as 0."),
        (b"@MOVRALL 20 20", "1 of 3 numbers is missing and counted as 0."),
        (b"@MOVRALL 20;20;20", "`20;20;20` is read as 20; 2 of 3 numbers are missing and counted as 0."),
        (b"@MOVRX 20,5", "`20,5` is read as 20."),
        (b"@MOVRX 1e3", "`1e3` is read as 1."),
        (b"@MOVRX  7 200", "two spaces in a row enclose an empty word, which counts as 0."),
        (b"@MOVRX ", "the number is missing and counted as 0."),
        (b"@MOVTORPOS nan 5", "`nan` is no number and counts as 0."),
        (
            b"@MOVAALL 1  None",
            "`None` is no number and counts as 0; two spaces in a row enclose an empty word, which counts as 0.",
        ),
        (b"@MOVRX -7", ""),
        (b"@MOVRX +5 fast", ""),
        (b"@MOVRX 3.9", ""),
        (b"@MOVRX 7 ", ""),
        (b"@MOVRALL 1 2 3 0 x y z 0", ""),
        (b"@MOVHOME", ""),
    ],
)
def test_words_that_are_no_numbers_are_named_with_what_they_count_as(text: bytes, read: str) -> None:
    assert misread(text) == read


def test_a_damaged_answer_has_as_many_lines_as_the_protocol_requires() -> None:
    answer = Answer()
    assert answer.add(ACK) == [ACK]
    answer.damaged = True
    assert answer.finish(ACK, data=True) == [NACK], "the numbers are lost"
    assert Answer(damaged=True).finish(ACK, data=False) == [ACK, ACK]


class Port:
    """A queue with a program, a node that permits every action, and a board that answers ACK, ACK."""

    def __init__(self) -> None:
        self.board = Mock(connected=True, state=0, telemetry=None, **{"wait_for.return_value": False})
        self.node = Mock(**{"move_refused.return_value": False})
        self.link = TextLink(self.board)
        self.queue = LineQueue(lambda _: None, self.link, self.node)
        self.queue.program_opened()
        self._seq = 0

    def lines(self) -> list[bytes]:
        """Return the lines that the board has received."""
        return [call.args[0] for call in self.board.send_text.call_args_list]

    def outcomes(self) -> list[tuple[str, Reason]]:
        """Return word and reason of each recorded outcome but the acceptance of motions."""
        recorded = self.node.record.call_args_list
        found = [(call.args[1], call.args[2].reason, call.kwargs.get("phase")) for call in recorded]
        return [
            (word, why) for word, why, phase in found if phase is not Phase.ACCEPTED or why is not Reason.OK
        ]

    def answer(self) -> None:
        for flags in (0, LAST):
            self.queue.receive(self._seq, Text(flags=flags, text=ACK), self.link.openings)
            self._seq += 1


def test_motors_off_is_queued_behind_any_number_of_lines_but_not_twice() -> None:
    port = Port()
    for _ in range(2 * CAPACITY):
        port.queue.take(b"@MOVRX 5")
    for _ in range(3):
        port.queue.take(b"@ENMOTORS OFF")
    assert port.outcomes().count(("@ENMOTORS", Reason.BUSY)) == 2
    port.queue.program_closed()
    port.answer()
    assert port.lines() == [b"@MOVRX 5", b"@ENMOTORS OFF"]
    port.answer()
    assert port.outcomes()[-1] == ("@ENMOTORS", Reason.OK)
