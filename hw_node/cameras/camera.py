"""The cameras of the robot: the values of `--camera`, and the component that publishes the pictures of an eye."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import WrongUsage, quoted, wrong_usage
from beatrix_zenoh.node import Component, Node, camera_publisher
from beatrix_zenoh.node.sensors import SILENT_S, Sensor, SensorSource
from hw_node.cameras.stand_ins import Pattern, PictureFiles

SILENCE: Final = f"The camera is plugged in but has delivered no picture for {SILENT_S:g} s. Unplug it, and plug it in again."


def camera_sensor(node: Node, eye: str, source: SensorSource) -> Component:
    """Return one eye of the robot."""
    publisher = camera_publisher(keys.camera(node.name, node.side, eye), node.events, source.name)
    return Sensor(f"{eye} eye", source, publisher, SILENCE)


PATTERN, FILE = "pattern", "file:"


@dataclass(frozen=True)
class CameraChoice:
    """The source of one eye."""

    eye: str
    source: str
    """`pattern`, `file:PATH`, or a USB camera: its path (Linux) or its number"""

    def build(self) -> SensorSource:
        """Create the source without opening it."""
        if self.source == PATTERN:
            return Pattern(self.eye)
        if self.source.startswith(FILE):
            return PictureFiles(Path(self.source.removeprefix(FILE)))
        from hw_node.cameras import opencv  # noqa: PLC0415 - its library is an extra

        return opencv.OpenCvCamera(self.source, opencv.library())

    def sensor(self, node: Node) -> Component:
        """Create the sensor of this eye."""
        return camera_sensor(node, self.eye, self.build())

    @property
    def device(self) -> Path | int | None:
        """The USB camera, however its path or number is written; None: it is no USB camera."""
        if self.source == PATTERN or self.source.startswith(FILE):
            return None
        return int(self.source) if self.source.isdigit() else Path(self.source).resolve()

    def mistake(self) -> str:
        """Return why the source can never work, else an empty text; a missing camera may be plugged in later."""
        source = self.source
        if source == PATTERN or source.startswith(FILE):
            return self.build().trouble().rstrip(".")
        if not source.startswith("/") and not (source.isascii() and source.isdigit()):
            return f"{quoted(source)} is neither a path that begins with / nor a number. Choose {examples()}"
        if importlib.util.find_spec("cv2") is None:
            return "USB cameras need opencv-python-headless: beatrix install cameras"
        return ""


TEST_EYES: Final = tuple(CameraChoice(eye, PATTERN).sensor for eye in names.EYES)
"""the sensors of two eyes that show a test picture"""


def examples() -> str:
    """Return examples of values of --camera on this system."""
    usb = "/dev/v4l/by-path/…" if sys.platform.startswith("linux") else "0"
    return f"left={usb} (a USB camera), left=pattern (a test picture), or left=file:PATH (pictures)"


def choices(words: Sequence[str]) -> list[CameraChoice]:
    """Convert words of the form `EYE=SOURCE` to checked choices.

    Raises:
        WrongUsage: BAD_VALUE, with the mistake and the allowed values.
    """
    found: dict[str, CameraChoice] = {}
    for word in words:
        eye, _, source = word.partition("=")
        if eye not in names.EYES or not source:
            raise wrong(word, f"give an eye, left or right, and its source: {examples()}")
        if eye in found:
            raise wrong(word, f"the {eye} eye has a camera already. Name each eye only once")
        choice = CameraChoice(eye, source)
        if mistake := choice.mistake():
            raise wrong(word, mistake)
        if choice.device is not None and any(one.device == choice.device for one in found.values()):
            raise wrong(word, f"the other eye has this camera already. Choose {examples()}")
        found[eye] = choice
    return list(found.values())


def wrong(word: str, what: str) -> WrongUsage:
    """Return the error for an invalid value of --camera."""
    return wrong_usage(f"camera {word}: {what}.")
