"""The statistics of `beatrix hz`, and lines of `beatrix echo`."""

from __future__ import annotations

import json
import time
from typing import NamedTuple

import pytest

from beatrix_zenoh.cli.streams import Rate, event_line, rate, show, show_rates
from beatrix_zenoh.client.subscription import Arrival, CameraImage
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Phase
from beatrix_zenoh.contract.errors import NoAnswer

PERIOD_NS = 20_000_000


class Publication(NamedTuple):
    seq: int
    t_wall_ns: int


def figures(*numbers: int) -> Rate:
    """Return the statistics of publications with these sequence numbers, a period of 20 ms and an age of 2 ms."""
    times = [index * PERIOD_NS for index in range(len(numbers))]
    return rate(
        [
            Arrival(Publication(seq, t_ns - 2_000_000), "bea", "hw", t_ns, t_ns)
            for seq, t_ns in zip(numbers, times, strict=True)
        ],
        0.0,
    )


def test_gaps_in_the_sequence_numbers_are_losses() -> None:
    assert figures(7, 8, 9, 10) == Rate(4, 50.0, 0.0, 20.0, 2.0, 0)
    assert figures(7, 9, 10, 13).lost == 3


@pytest.mark.parametrize(
    "numbers",
    [
        (500, 7, 501, 8, 502, 9),  # two programs
        (7, 500, 8, 501),
        (500, 501, 1, 2),  # a restart
        (7, 7, 8),
    ],
)
def test_losses_are_unknown_if_sequence_numbers_decrease(
    numbers: tuple[int, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    found = figures(*numbers)
    assert found.lost is None
    show_rates({"bea (hw)": found})
    printed = capsys.readouterr().out
    assert printed.splitlines()[1].split()[-1] == "?"
    assert "a second program publishes on its key" in printed


def test_two_publications_are_too_few_for_statistics() -> None:
    with pytest.raises(NoAnswer, match="2 messages arrived; at least 3 are needed"):
        figures(1, 2)


# -- the line that `beatrix echo` prints for an event ----------------------------------------------


def test_an_event_is_one_line_with_time_robot_seat_and_outcome() -> None:
    noon_ns = round(time.mktime((2026, 11, 22, 12, 0, 0, 0, 0, -1)) * 1e9)
    event = Event(
        seq=7, t_mono_ns=0, t_wall_ns=noon_ns + 45_678_901, kind=EventKind.MOTION, action="pose", seat="ana",
        phase=Phase.ACCEPTED, message="Text.",
    )  # fmt: skip
    assert event_line(("bea", "hw"), event) == "12:00:00.045  bea (hw)  ana motion pose accepted: Text."


def test_a_picture_is_shown_by_its_header(capsys: pytest.CaptureFixture[str]) -> None:
    image = CameraImage(
        seq=7, t_mono_ns=1, t_wall_ns=2, width=64, height=48, source="pattern", jpeg=b"\xff\xd8", eye="left",
        arrived_mono_ns=3, arrived_wall_ns=4,
    )  # fmt: skip
    show(("bea", "hw"), image, as_json=False)
    show(("bea", "hw"), image, as_json=True)
    words, document = capsys.readouterr().out.splitlines()
    assert words == f"bea (hw)  {image}"
    shown = json.loads(document)
    assert (shown["eye"], shown["seq"], shown["bytes"], "jpeg" in shown) == ("left", 7, 2, False)
