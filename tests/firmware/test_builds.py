"""The same sources for every body: same bytes, same behaviour, no undefined operation."""

from __future__ import annotations

import filecmp
import random
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from rig import ROOT, SPEED_MAX, Core, HostFirmware

from beatrix_zenoh._generated.serial import Enable, FrameType, Move
from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware

pytestmark = pytest.mark.xdist_group("firmware-builds")
SHIPPED = ROOT / "beatrix_zenoh/board/firmware.wasm"
Build = Callable[..., Path]


def test_the_shipped_wasm_is_what_its_sources_make(build: Build, tmp_path: Path) -> None:
    build("wasm", "clang++-14", f"WASM={tmp_path / 'firmware.wasm'}")
    assert filecmp.cmp(tmp_path / "firmware.wasm", SHIPPED, shallow=False), "run `make firmware`, commit it"


def test_the_core_compiles_without_a_warning(build: Build) -> None:
    build("check", "clang++-14")


def script(core: Core, seed: int) -> bytes:
    """Everything the firmware says to a random life: moves, stops, noise, emergencies, and time."""
    chance = random.Random(seed)
    said = [core.transmit()]
    for seq in range(1, 250):
        target = tuple(chance.randint(-600, 600) for _ in range(3))
        speed = tuple(chance.randint(1, SPEED_MAX) for _ in range(3))
        move = Move(chance.randint(0, 1), seq, target, speed).pack()  # type: ignore[arg-type]
        data = chance.choices(
            [
                encode(FrameType.MOVE, seq, move),
                encode(FrameType.STOP, seq, b""),
                encode(FrameType.ENABLE, seq, Enable(chance.randint(0, 1)).pack()),
                encode(FrameType.CALIBRATE, seq, b""),
                encode(FrameType.EMERGENCY_STOP, seq, b""),
                chance.randbytes(30),
            ],
            [12, 2, 2, 3, 0.2, 1],
        )
        core.receive(b"".join(data))
        core.tick(chance.randint(0, 700))
        said.append(core.transmit())
    return b"".join(said)


def test_wasm_and_host_say_the_same_bytes(build: Build) -> None:
    library = build("host", "g++") / "libbeatrix.so"
    for seed in range(3):
        said = script(Firmware(), seed)
        assert len(said) > 100_000
        assert said == script(HostFirmware(library), seed)


def test_no_operation_is_undefined(build: Build) -> None:
    program = build("sanitize", "clang++-14") / "sanitized"
    for seed in range(10):
        subprocess.run([program], input=random.Random(seed).randbytes(30_000), check=True, timeout=50)


def test_a_bounded_fuzz_finds_nothing(build: Build) -> None:
    build("fuzz", "clang++-14", "FUZZ_RUNS=20000")
