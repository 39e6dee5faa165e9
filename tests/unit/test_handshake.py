"""Handshake: no bytes to a board that may have been reset; HELLO at once to a board that sends a frame."""

from __future__ import annotations

import itertools

import pytest

from beatrix_zenoh.board.timing import BOOT_S, FOREIGN_S, HELLO_S, LOADER_S, TRIES, Handshake

STEP_S = 0.01
LOADER_LISTENS_S, LOADER_WAITS_S = 0.9, 5.0
"""Time that the boot loader waits for a first byte, and after the last one. test_boot_loader.py runs a real one."""


def hello_times(handshake: Handshake, until_s: float, *, foreign: bool = False) -> list[float]:
    """Return the times (s) of HELLO from 0 to `until_s`."""
    times = []
    for now in itertools.takewhile(lambda t: t < until_s, (n * STEP_S for n in itertools.count())):
        if handshake.due(now):
            handshake.hello_sent(now, foreign=foreign)
            times.append(now)
    return times


def test_nothing_is_sent_while_the_board_starts() -> None:
    first, *rest = hello_times(Handshake(0.0, BOOT_S), 20.0)
    assert first == pytest.approx(BOOT_S, abs=STEP_S)
    assert first > LOADER_LISTENS_S
    assert rest[0] - first == pytest.approx(HELLO_S, abs=2 * STEP_S)


def test_pauses_between_hellos_are_long_enough_for_a_boot_loader() -> None:
    times = hello_times(Handshake(0.0, 0.0), 30.0)
    pauses = [later - earlier for earlier, later in itertools.pairwise(times)]
    assert [pause > LOADER_WAITS_S for pause in pauses[: 2 * TRIES]] == 2 * ([False] * (TRIES - 1) + [True])


def test_after_a_loss_there_is_a_pause_unless_a_frame_arrives() -> None:
    handshake = Handshake(0.0, 0.0)
    handshake.hello_sent(0.0, foreign=False)
    handshake.lost(1.0)
    assert not handshake.due(1.0 + LOADER_WAITS_S)
    assert handshake.due(1.0 + LOADER_S)
    handshake.frame_received()
    assert handshake.due(1.0)


def test_hellos_to_foreign_firmware_are_too_rare_for_a_heartbeat() -> None:
    times = hello_times(Handshake(0.0, 0.0), 10.0, foreign=True)
    assert min(later - earlier for earlier, later in itertools.pairwise(times)) > FOREIGN_S - STEP_S
