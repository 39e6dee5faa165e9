"""The simulated ears: a client plays a sound in the room, and hears where it comes from."""

from __future__ import annotations

import runpy
import wave
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from robots import Stage

from beatrix_zenoh import Robot
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.sound import Sound
from beatrix_zenoh.contract.errors import WrongUsage

EXAMPLES = Path(__file__).resolve().parents[2] / "beatrix_zenoh/examples"


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as stage:
        stage.simulation("bea", "--ready")
        yield stage


@pytest.fixture
def robot(stage: Stage) -> Iterator[Robot]:
    robot = stage.robot("bea", "sim")
    robot.play_sound("silence")
    robot.place_sound()
    robot.move(0, 0, 0, speed=90)
    yield robot
    robot.client.close()


def difference_db(sound: Sound) -> float:
    left, right = sound.level
    return left - right


@pytest.mark.long("listens in real time")
def test_a_sound_is_louder_on_its_side_and_the_head_turns_its_ears(robot: Robot) -> None:
    robot.place_sound(0.3, 1.5, 0.1)
    robot.play_sound("noise", 60)
    assert difference_db(robot.listen(0.4)) > 3.0
    robot.look(yaw=78.7, speed=90)
    assert abs(difference_db(robot.listen(0.4))) < 1.0
    robot.look(yaw=160, speed=90)
    assert difference_db(robot.listen(0.4)) < -3.0


def test_a_file_of_a_client_is_heard_at_its_pitch(robot: Robot, tmp_path: Path) -> None:
    tone = 0.5 * np.sin(2 * np.pi * 800 * np.arange(22_050) / 22_050)
    with wave.open(str(tmp_path / "tone.wav"), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(22_050)
        file.writeframes((tone * 32767).astype("<i2").tobytes())
    assert robot.play_sound(tmp_path / "tone.wav", seconds=30).play == "samples"
    sound = robot.listen(0.5)
    spectrum = np.abs(np.fft.rfft(sound.left))
    assert spectrum.argmax() * sound.rate / len(sound.left) == pytest.approx(800.0, abs=2.0)


def test_a_program_nods_at_a_clap(robot: Robot) -> None:
    program = runpy.run_path(str(EXAMPLES / "nod_at_a_clap.py"))
    nods: list[float] = []

    def look(pitch: float, speed: float, *, wait: bool) -> Motion:
        nods.append(pitch)
        if len(nods) == 2:
            raise KeyboardInterrupt
        return robot.look(pitch=pitch, speed=speed, wait=wait)

    robot.play_sound("clap", 20)
    with pytest.raises(KeyboardInterrupt):
        program["nod"]([SimpleNamespace(microphones=robot.microphones, look=look)])
    assert nods == [program["NOD"], 0.0]


def test_a_place_without_height_and_a_sound_without_length_are_refused(robot: Robot) -> None:
    with pytest.raises(WrongUsage, match="needs x, y and z"):
        robot.place_sound(1, 0)
    with pytest.raises(WrongUsage, match="seconds"):
        robot.play_sound("noise", 0)
