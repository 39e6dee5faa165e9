"""Resets, hangs and silence of the Mega, and its EEPROM."""

from __future__ import annotations

import random

import pytest
from avr.mega import START_MS, Mega, pin_faults

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.contract._generated.serial import (
    CONTRACT,
    BoardState,
    Error,
    FrameType,
    HelloReply,
)

WATCHDOG_MS = 256
"""Timeout of WDTO_250MS: 32 768 cycles at 128 kHz."""


def hello(mega: Mega) -> HelloReply:
    """Send HELLO; return the reply."""
    (reply,) = mega.raw(encode(FrameType.HELLO, 1, b""))
    return HelloReply.unpack(reply.payload)


def test_a_new_board_has_no_name_and_boot_number_1_and_its_drivers_stay_off() -> None:
    with Mega() as mega:
        reply = hello(mega)
        assert (reply.contract, reply.boot, reply.name) == (CONTRACT, 1, bytes(32))
        assert not mega.avr.enabled
        assert len(mega.avr.edges("enable")) == 0


@pytest.mark.long("a search, cycle by cycle")
def test_a_reset_during_start_does_not_reuse_a_boot_number() -> None:
    chance = random.Random(3)
    boot_numbers = [0]
    with Mega() as mega:
        for _ in range(150):
            mega.avr.reset()
            mega.discard_interrupted_frame()
            mega.avr.run(chance.randint(0, 600_000))
            replies = mega.raw(encode(FrameType.HELLO, 1, b""))
            boot_numbers += [HelloReply.unpack(frame.payload).boot for frame in replies]
    assert len(boot_numbers) > 30
    assert boot_numbers == sorted(set(boot_numbers))


def test_a_name_survives_resets_and_power_loss() -> None:
    with Mega() as mega:
        for name in (b"bea-1", b"bea-2", b"x" * 32):
            assert mega.ask(FrameType.SET_NAME, name.ljust(32, b"\0")) == Error.OK
            mega.tick(200)
            mega.restart()
            assert hello(mega).name.rstrip(b"\0") == name
        kept = mega.avr.eeprom
    with Mega(eeprom=kept) as mega:
        assert hello(mega).name == b"x" * 32


@pytest.mark.long("a search, cycle by cycle")
def test_a_reset_during_a_name_write_leaves_the_old_or_the_new_name() -> None:
    chance = random.Random(4)
    seen = set()
    with Mega() as mega:
        assert mega.ask(FrameType.SET_NAME, b"old-name".ljust(32, b"\0")) == Error.OK
        mega.tick(200)
        kept = mega.avr.eeprom
    for _ in range(40):
        with Mega(eeprom=kept) as mega:
            assert mega.ask(FrameType.SET_NAME, b"new-longer-name".ljust(32, b"\0")) == Error.OK
            mega.restart(after_cycles=chance.randint(0, 2_500_000))
            seen.add(hello(mega).name.rstrip(b"\0"))
    assert seen == {b"old-name", b"new-longer-name"}


@pytest.mark.parametrize("cells", [b"\xff" * 4096, bytes(4096), random.Random(1).randbytes(4096)])
def test_any_eeprom_content_gives_a_boot_number_and_no_invalid_name(cells: bytes) -> None:
    with Mega(eeprom=cells) as mega:
        first = hello(mega)
        mega.restart()
        assert hello(mega).boot == first.boot + 1
        assert first.name == bytes(32)


def test_a_main_loop_that_hangs_is_restarted_with_the_motors_off() -> None:
    mega = Mega()
    try:
        mega.ready()
        mega.move((1500, 1500, 1500), 4000)
        mega.tick(100)
        assert mega.avr.enabled
        broken = mega.avr.hang()
        mega.tick(WATCHDOG_MS - 10)
        assert mega.avr.resets == 0
        mega.tick(20)
        assert mega.avr.resets == 1
        assert not mega.avr.enabled
        mega.avr.mend(broken)
        mega.discard_interrupted_frame()
        mega.tick(START_MS + 20)
        assert hello(mega).boot == 2
        mega.tick(20)
        assert mega.state == BoardState(0)
        assert pin_faults(mega.avr) == []
        at = mega.steps
        mega.tick(300)
        assert (mega.steps, mega.avr.resets) == (at, 1)
    finally:
        mega.avr.close()


def test_the_watchdog_does_not_expire_at_rest_in_motion_or_in_a_flood_of_requests() -> None:
    with Mega() as mega:
        mega.tick(1000)
        mega.ready()
        mega.move((600, 600, 600), 2000)
        mega.avr.send(encode(FrameType.PING, 1, b"") * 2000)
        mega.tick(1000)
        mega.run()
        mega.settle()
        assert mega.avr.resets == 0
        assert mega.last.position == mega.steps == (600, 600, 600)
