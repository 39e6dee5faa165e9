"""Tables of a recording with rotation contain what a raw Zenoh subscriber received meanwhile, to the last bit."""

from __future__ import annotations

import json
import threading
from dataclasses import dataclass, field
from pathlib import Path

import msgpack
import numpy as np
import numpy.typing as npt
import pandas as pd
import pytest
import zenoh
from robots import Stage, ready, until

from beatrix_zenoh.cli import app

SIDES = ("sim", "hw")
ROTATE_MIN = 0.1
"""The shortest length of a file: 6 s."""
FILES = 3
ARMS, HEAD = ("short", "middle", "long"), ("yaw", "pitch", "roll")
FIELDS = {
    "position": [f"{arm}_deg" for arm in ARMS],
    "commanded": [f"{arm}_commanded_deg" for arm in ARMS],
    "velocity": [f"{arm}_velocity_deg_s" for arm in ARMS],
    "head": [f"{axis}_deg" for axis in HEAD],
    "head_measured": [f"{axis}_measured_deg" for axis in HEAD],
}
"""Columns of each field of the messages."""

Message = dict[str, object]
Singles = npt.NDArray[np.float32]


@dataclass
class RawLog:
    """Messages of positions by twin and number, as a program without BEATRIX receives them."""

    messages: dict[tuple[str, int], Message] = field(default_factory=dict)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def add(self, sample: zenoh.Sample) -> None:
        side = str(sample.key_expr).split("/")[2]
        message = msgpack.unpackb(sample.payload.to_bytes())
        with self.lock:
            self.messages[side, message["seq"]] = message

    def samples(self, side: str, first: int, last: int) -> list[int]:
        """Return the numbers of the messages that repeat no other."""
        numbers = [number for number in self.numbers(side) if first <= number <= last]
        return [number for number in numbers if not self.messages[side, number]["repeated"]]

    def numbers(self, side: str) -> list[int]:
        with self.lock:
            return sorted(number for of, number in self.messages if of == side)


@dataclass(frozen=True)
class Lesson:
    """Files of a rotated recording, and the raw messages."""

    files: list[Path]
    raw: RawLog


@pytest.fixture(scope="module")
def lesson(stage: Stage, tmp_path_factory: pytest.TempPathFactory) -> Lesson:
    """Record both robots in three files while they move."""
    folder, raw = tmp_path_factory.mktemp("lesson"), RawLog()
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([stage.endpoint]))
    config.insert_json5("scouting/multicast/enabled", "false")
    robots = [ready(stage.robot("bea", side)) for side in SIDES]
    with zenoh.open(config) as session:
        subscriber = session.declare_subscriber("beatrix/bea/*/state/positions", raw.add)
        until(lambda: all(raw.numbers(side) for side in SIDES), "positions of both")
        words = ("record", str(folder / "day.rrd"), "--connect", stage.endpoint, "--cameras", "0")
        process = stage.process("beatrix_zenoh.cli", *words, "--rotate", str(ROTATE_MIN), "--name", "bea")
        process.expect_all("Recording bea (hw).", "Recording bea (sim).")
        yaw = 40
        while not (folder / f"day-{FILES:03d}.rrd").exists():
            yaw = -yaw
            for motion in [robot.look(yaw=yaw, pitch=8, wait=False) for robot in robots]:
                motion.wait()
        last = {side: raw.numbers(side)[-1] for side in SIDES}
        until(lambda: all(raw.numbers(side)[-1] > last[side] + 50 for side in SIDES), "a second more")
        assert process.end() == 0
        subscriber.undeclare()
    return Lesson(sorted(folder.glob("day-*.rrd")), raw)


def as_published(table: pd.DataFrame, columns: list[str]) -> Singles:
    """Return columns in deg as the float32 in rad of a message."""
    radians: Singles = np.radians(table[columns].to_numpy(np.float64)).astype(np.float32)
    return radians


def of_messages(messages: list[Message], name: str) -> Singles:
    """Return a vector of the messages as float32 (n, 3); NaN where it is missing."""
    return np.array(
        [list((message.get(name) or dict.fromkeys("xyz", np.nan)).values()) for message in messages],  # type: ignore[attr-defined]
        np.float64,
    ).astype(np.float32)


@pytest.mark.long("records three files")
@pytest.mark.parametrize(("suffix", "load"), [(".csv", pd.read_csv), (".parquet", pd.read_parquet)])
@pytest.mark.parametrize("side", SIDES)
def test_every_sample_is_in_the_table_to_the_last_bit(
    lesson: Lesson, tmp_path: Path, suffix: str, load: type, side: str
) -> None:
    assert len(lesson.files) >= FILES
    path = tmp_path / f"day{suffix}"
    assert app.run(["export", *map(str, lesson.files), str(path), "--samples"]) == 0
    rows = load(path).query("side == @side")
    numbers = rows.seq.astype(int).tolist()
    first, last = numbers[0], numbers[-1]
    assert last - first > 600
    assert len(set(numbers)) == len(numbers), "no sample is in two files"
    published = [number for number in lesson.raw.numbers(side) if first <= number <= last]
    assert published == list(range(first, last + 1)), "the network lost nothing"
    assert sorted(numbers) == lesson.raw.samples(side, first, last)
    assert (rows.seq.diff() - rows.repeats)[1:].eq(1).all()
    messages = [lesson.raw.messages[side, number] for number in numbers]
    assert rows.robot_time_ns.tolist() == [message["t_wall_ns"] for message in messages]
    for name, columns in FIELDS.items():
        np.testing.assert_array_equal(as_published(rows, columns), of_messages(messages, name), name)
    assert np.ptp(rows.yaw_deg) > 60, "it moved"
