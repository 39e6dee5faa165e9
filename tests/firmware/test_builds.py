"""Builds of the firmware: same bytes, same behaviour on every target, no undefined behaviour."""

from __future__ import annotations

import filecmp
import random
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from avr.mega import HEX, Mega, MegaPort
from dialogues import DIALOGUES, expected_replies, read
from firmware_host import ROOT
from text_port_programs import Program

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.contract._generated.serial import CONTRACT, FrameType, HelloReply

SHIPPED = ROOT / "beatrix_zenoh/board/firmware.wasm"
Build = Callable[..., Path]


def test_the_shipped_wasm_is_built_from_its_sources(build: Build, tmp_path: Path) -> None:
    build("wasm", "clang++-14", f"WASM={tmp_path / 'firmware.wasm'}")
    assert filecmp.cmp(tmp_path / "firmware.wasm", SHIPPED, shallow=False), (
        "run `make firmware` and commit it"
    )


def test_the_shipped_hex_is_built_from_its_sources(build: Build, tmp_path: Path) -> None:
    build("mega", "avr-g++", f"HEX={tmp_path / 'mega.hex'}")
    assert filecmp.cmp(tmp_path / "mega.hex", HEX, shallow=False), "run `make firmware` and commit it"


@pytest.mark.long("builds firmware and runs dialogues cycle by cycle")
@pytest.mark.parametrize("path", DIALOGUES, ids=lambda path: path.stem)
def test_built_for_9600_baud_the_mega_replies_as_a_board_of_2023(
    build: Build, tmp_path: Path, path: Path
) -> None:
    build("mega", "avr-g++", "BAUD=9600", f"HEX={tmp_path / 'drop-in.hex'}")
    dialogue = read(path)
    with MegaPort(tmp_path / "drop-in.hex", baud=9600) as mega:
        program = Program(mega, look_ms=1)
        for entry in dialogue:
            if entry.to_robot:
                program.tick(entry.ms - program.ms)
                program.send(entry.text.encode("ascii"))
        program.tick(5000)
    assert [line for _, line in program.lines] == [entry.text for entry in expected_replies(dialogue)]
    for (ms, _), old in zip(program.lines, expected_replies(dialogue), strict=True):
        assert ms <= old.ms


@pytest.mark.long("builds firmware")
def test_firmware_for_other_jumpers_reports_another_contract(build: Build, tmp_path: Path) -> None:
    other = tmp_path / "other.toml"
    other.write_text("[drive]\nmicrosteps = 16\n", encoding="utf-8")
    build("mega", "avr-g++", f"ROBOT={other}", f"HEX={tmp_path / 'other.hex'}")
    contracts = []
    for firmware in (HEX, tmp_path / "other.hex"):
        with Mega(firmware) as mega:
            (reply,) = mega.raw(encode(FrameType.HELLO, 1, b""))
            contracts.append(HelloReply.unpack(reply.payload).contract)
    assert contracts[0] == CONTRACT
    assert contracts[1] != CONTRACT


def test_make_resolves_relative_paths_in_the_folder_of_the_repository() -> None:
    command = ["make", "-n", "-C", "firmware", "mega", "ROBOT=lab.toml", "HEX=lab.hex"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=50)
    assert f"--robot {ROOT / 'lab.toml'} " in done.stdout
    assert f" {ROOT / 'lab.hex'}" in done.stdout


@pytest.mark.long("sanitizers")
def test_random_input_causes_no_undefined_behaviour(build: Build) -> None:
    program = build("sanitize", "clang++-14") / "sanitized"
    for seed in range(10):
        subprocess.run([program], input=random.Random(seed).randbytes(30_000), check=True, timeout=50)


@pytest.mark.long("fuzzing")
def test_a_bounded_fuzz_run_finds_no_error(build: Build) -> None:
    build("fuzz", "clang++-14", "FUZZ_RUNS=20000")
