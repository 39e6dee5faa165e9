"""Fixtures of the firmware tests: builds, boards."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from avr.mega import Mega, MegaPort
from firmware_host import ROOT, Core, Rig
from text_port_programs import Program

from beatrix_zenoh.board.virtual import Firmware

Build = Callable[..., Path]
ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
PACKAGES = {"clang++-14": "clang-14 lld-14 libclang-rt-14-dev", "avr-g++": "gcc-avr avr-libc"}


@pytest.hookimpl(tryfirst=True)  # this runs before the hook for all tests, which may remove the mark
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark firmware tests, except `test_flash`, to run without coverage, which makes them much slower."""
    here = Path(__file__).parent
    for item in items:
        if item.path.parent == here and item.path.stem != "test_flash":
            item.add_marker(pytest.mark.no_cover)


@pytest.fixture(scope="session")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """Return a function that builds a target of firmware/Makefile in a folder of this session.

    Skips the test if the compiler is not installed.
    """
    folder = tmp_path_factory.mktemp("firmware")

    def make(target: str, compiler: str, *settings: str) -> Path:
        if shutil.which(compiler) is None:
            pytest.skip(f"{compiler} is not installed: apt-get install {PACKAGES[compiler]}")
        command = ["make", "-s", "-C", str(ROOT / "firmware"), target, f"BUILD={folder}", *settings]
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, env={**os.environ, "MAKEFLAGS": ""}
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return folder

    return make


@pytest.fixture(scope="session")
def sketch(build: Build) -> Path:
    """The hex file of the sketch, compiled as in the Arduino IDE."""
    if not ARDUINO.exists():
        pytest.skip(f"{ARDUINO} is missing: apt-get install arduino-core-avr")
    return build("arduino", "avr-g++") / "beatrix.ino.hex"


@pytest.fixture(params=["virtual", pytest.param("mega", marks=pytest.mark.long("cycle by cycle"))])
def body(request: pytest.FixtureRequest) -> Iterator[Core]:
    """The firmware on each target, for a Program."""
    if request.param == "virtual":
        yield Firmware()
        return
    with MegaPort() as mega:
        yield mega


@pytest.fixture
def rig() -> Rig:
    """A board after reset."""
    return Rig()


@pytest.fixture
def ready() -> Rig:
    """A board enabled and calibrated."""
    return Rig().ready()


@pytest.fixture
def program() -> Program:
    """A program of 2023 at a board of its own, which may move."""
    return Program().ready()


@pytest.fixture
def framed() -> Program:
    """A program of 2023 behind a host, at a board that may move."""
    return Program(framed=True).ready()


@pytest.fixture
def mega() -> Iterator[Mega]:
    """A Mega enabled and calibrated, whose pins are checked at the end of the test."""
    with Mega() as board:
        board.ready()
        yield board
