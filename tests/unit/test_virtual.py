"""The virtual board: a port like a serial one, in virtual time or in real time."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import pytest
from firmware_host import Rig

from beatrix_zenoh.board import virtual, wasm
from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import TICKS, Firmware, VirtualBoard
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import FrameType, Telemetry
from beatrix_zenoh.contract.errors import BeatrixError

HELLO, PING = encode(FrameType.HELLO, 3, b""), encode(FrameType.PING, 3, b"")


@pytest.fixture
def board() -> Iterator[VirtualBoard]:
    board = VirtualBoard(Firmware(boot=7, name="bea1"))
    board.write(HELLO)
    yield board
    board.close()


def test_close_wakes_a_reader_and_rejects_writes(board: VirtualBoard) -> None:
    board.read(0)
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(board.read(30)))
    reader.start()
    board.close()
    reader.join(30)
    assert got == [b""]
    with pytest.raises(OSError, match="closed"):
        board.write(b"\0")


def test_unread_bytes_are_limited(board: VirtualBoard) -> None:
    for _ in range(60):
        board.advance(1000)
        board.write(PING)
    assert len(board.read(0)) == virtual._UNREAD_MAX


def test_the_motors_of_one_long_call_are_those_of_many_short_ones() -> None:
    short, long = Firmware(), Firmware()
    for firmware in (short, long):
        Rig(firmware).ready().move((300, -200, 50))
    for ms in (20, 100, 2, 400):
        one_by_one = []
        for _ in range(min(ms, TICKS) // 2):
            short.tick(2)
            one_by_one.append((short.pulses(), short.drivers_on()))
        long.tick(min(ms, TICKS))
        runs = long.motors(min(ms, TICKS), 2)
        assert [(pulses, on) for pulses, on, count in runs for _ in range(count)] == one_by_one
    assert short.transmit() == long.transmit()
    assert long.pulses() != (0, 0, 0)
    long.tick(1000)
    long.tick(100)
    assert long.motors(100, 2) == [(long.pulses(), True, 50)]


def test_a_missing_wasmtime_is_an_error_with_the_command_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "wasmtime", None)
    wasm.compiled.cache_clear()
    with pytest.raises(BeatrixError, match="beatrix install sim") as caught:
        Firmware()
    assert caught.value.reason == Reason.BOARD_LOST


def run_script(firmware: Firmware) -> tuple[list[Telemetry], bytes]:
    """Return the telemetry of a board during a short motion, and its memory afterwards."""
    rig = Rig(firmware).ready()
    rig.move((90, -60, 30), 400)
    rig.tick(50)
    return rig.telemetry, firmware.snapshot()


def test_direct_calls_equal_those_of_wasmtime(monkeypatch: pytest.MonkeyPatch) -> None:
    direct = run_script(Firmware())
    monkeypatch.delattr("wasmtime._ffi.wasmtime_val_raw_t")
    assert run_script(Firmware()) == direct
