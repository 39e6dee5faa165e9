"""Gaps of a log: each is counted, and has the name of its cause."""

from __future__ import annotations

import time

import msgspec
import numpy as np
import pytest
from golden import same
from hypothesis import given
from hypothesis import strategies as st
from statuses import AT_HOME

from beatrix_zenoh.client.log import find_gaps
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.contract.publishers import NUMBERS
from beatrix_zenoh.recording.losses import (
    EVENTS,
    POSITIONS,
    Count,
    Losses,
    LossReport,
    Stream,
    findings,
    pictures_of,
    total,
)
from beatrix_zenoh.recording.rows import Line
from beatrix_zenoh.recording.samples import lost as lost_in_file
from beatrix_zenoh.recording.verbs.record import missing, outcome


def positions(*steps: tuple[int, float]) -> list[Positions]:
    """Return positions with these numbers and times (s)."""
    return [msgspec.structs.replace(AT_HOME, seq=seq, t_mono_ns=round(t * 1e9)) for seq, t in steps]


@pytest.mark.parametrize(
    ("steps", "lost", "cause"),
    [
        ([(1, 0.0), (2, 0.02), (3, 0.04)], None, ""),
        ([(1, 0.0), (4, 0.06)], 2, "2 were lost on the way"),
        ([(1, 0.0), (11, 0.2)], 9, "9 were lost on the way"),
        ([(1, 0.0), (2, 0.2)], 0, "the robot had no new ones"),
        ([(1, 0.0), (2, 0.0), (3, 0.2)], 0, "the robot had no new ones"),  # the second one repeats
        ([(90, 0.0), (1, 4.0)], 0, "the robot's node was started again"),
    ],
)
def test_a_gap_has_its_cause(steps: list[tuple[int, float]], lost: int | None, cause: str) -> None:
    given = positions(*steps)
    gaps = find_gaps(given, Arrival(given[-1], "bea", "hw", time.monotonic_ns(), 0))
    assert [(gap.lost, gap.cause) for gap in gaps] == ([] if lost is None else [(lost, cause)])


def test_silence_up_to_the_end_is_a_gap() -> None:
    given = positions((1, 0.0), (2, 0.02))
    gaps = find_gaps(given, Arrival(given[-1], "bea", "hw", time.monotonic_ns() - 2_000_000_000, 0))
    assert [(round(gap.t, 2), gap.cause) for gap in gaps] == [(0.02, "the robot was silent up to the end")]
    assert gaps[0].seconds == pytest.approx(2, abs=0.5)


# -- missing sequence numbers: each true loss is counted once, and nothing else is -----------------


BEA = ("bea", "hw")
ARMS: Stream = (BEA, POSITIONS)


def counted(*seqs: int, dropped: int = 0) -> Count:
    """Return the counts after positions with these numbers."""
    losses = Losses()
    for seq in seqs:
        losses.received(ARMS, seq)
    return losses.counts({ARMS: dropped})[ARMS]


@given(
    first=st.integers(0, NUMBERS - 1),
    fates=st.lists(st.sampled_from(["arrives", "lost", "dropped here"]), max_size=60),
)
def test_each_missing_number_is_one_loss_unless_our_queues_have_dropped_it(
    first: int, fates: list[str]
) -> None:
    """The numbers may pass the largest uint32; those before the first and after the last arrival are unknown."""
    fates = ["arrives", *fates, "arrives"]
    seqs = [(first + i) % NUMBERS for i, fate in enumerate(fates) if fate == "arrives"]
    found = counted(*seqs, dropped=fates.count("dropped here"))
    assert (found.lost, found.dropped) == (fates.count("lost"), fates.count("dropped here"))
    assert found.published == len(fates)


@pytest.mark.parametrize(
    ("seqs", "lost"),
    [
        ((), 0),
        ((7,), 0),
        ((700, 701, 702), 0),
        ((5, 6, 0, 1, 2), 0),
        ((5, 6, 1, 2), 0),
        ((5, 6, 3, 4, 6), 1),
        ((5, 5, 6), 0),
        ((NUMBERS - 1, 0, 1), 0),
        ((NUMBERS - 2, 1), 2),
        ((1, 4, 5, 9), 5),
    ],
)
def test_only_gaps_are_losses(seqs: tuple[int, ...], lost: int) -> None:
    assert total({ARMS: counted(*seqs)} if seqs else {}).lost == lost
    assert lost_in_file(np.array(seqs, np.int64), np.zeros(len(seqs), np.int64)) == lost


def test_pictures_that_a_router_leaves_out_are_no_lost_samples() -> None:
    counts = {(BEA, pictures_of("left")): Count(received=3, lost=187), (BEA, EVENTS): Count(received=3)}
    assert missing(counts) == "187 pictures did not arrive"


def test_two_programs_under_one_name_are_named_once_and_no_loss_is_counted() -> None:
    losses, said = Losses(), list[str]()
    report = LossReport(said.append)
    rows: list[Line] = []
    for k in range(200):
        for first in (1000, 7000):
            losses.received(ARMS, first + k)
            losses.received((BEA, EVENTS), first + 2 * k)
        rows += report.lines(losses.counts({}), k, 50 + k / 50, last=False)
    counts = losses.counts({})
    rows += report.lines(counts, 200, 1000, last=True)
    words = "Two programs publish the positions of bea (hw), so lost ones cannot be counted. End one of them."
    assert said == [words]
    assert [row.text for row in rows] == [words]
    assert list(findings(counts).values()) == [words]
    same(
        "recording losses.two programs under one name are named once and no loss is counted", missing(counts)
    )
    assert outcome(total(counts))["lost"] is None
    assert {one.lost for one in counts.values()} == {0}
