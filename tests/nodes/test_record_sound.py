"""`beatrix record --sound` with a simulation: microphones are on for it, and only for it; the file has every block."""

from __future__ import annotations

import wave
from pathlib import Path

import numpy as np
import pytest
from robots import Stage, until, wait_status

from beatrix_zenoh.cli import app
from beatrix_zenoh.recording.rrd.read import read_sound


@pytest.mark.long("listens in real time")
def test_a_recording_has_what_the_robot_hears(stage: Stage, tmp_path: Path) -> None:
    robot = stage.robot("bea", "sim")
    robot.place_sound(0.3, 1.5, 0.1)
    robot.play_sound("noise", 60)
    path, out = tmp_path / "lesson.rrd", tmp_path / "lesson.wav"
    process = stage.recorder(path, "--name", "bea", "--cameras", "0", "--seconds", "2", "--sound")
    wait_status(
        robot, lambda status: status.microphones is not None and status.microphones.streaming, "they are on"
    )
    assert process.wait() == 0
    until(lambda: not (heard := robot.status().microphones) or not heard.streaming, "the microphones are off")
    assert app.run(["export", str(path), "--sound", str(out)]) == 0
    blocks = read_sound([path], [("bea", "sim")], 0, 2**62)["bea", "sim"]
    numbers = [block.seq for block in blocks]
    lost = numbers[-1] - numbers[0] + 1 - len(numbers)
    assert lost == 0 or f"{lost} of {lost + len(numbers)} blocks of sound" in "\n".join(process.lines)
    with wave.open(str(out)) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2").reshape(-1, 2)
    assert len(samples) / 48_000 > 0.5
    left, right = np.sqrt(np.mean(np.square(samples, dtype=float), axis=0))
    assert left > 1.4 * right, "the source is to the left"
