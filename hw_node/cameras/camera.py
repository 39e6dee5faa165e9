"""The cameras of the robot: the values of `--camera`, and the component that publishes the pictures of an eye."""

from __future__ import annotations

import importlib.util
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage, quoted
from beatrix_zenoh.node import CameraFrame, Node, camera_publisher
from beatrix_zenoh.node.sensors import SILENT_S, Sensor, SensorSource
from hw_node.cameras.stand_ins import Pattern, PictureFiles

SILENCE: Final = f"The camera is plugged in but has delivered no picture for {SILENT_S:g} s. Unplug it, and plug it in again."

FrameSource = SensorSource[CameraFrame]
"""A camera or another source of pictures."""


class CameraSensor(Sensor[CameraFrame]):
    """One eye of the robot."""

    def __init__(self, node: Node, eye: str, source: FrameSource) -> None:
        wake = threading.Event()
        key = keys.camera(node.name, node.side, eye)
        publisher = camera_publisher(key, node.events, source.name, wake.set)
        super().__init__(f"{eye} eye", source, publisher, wake, SILENCE)
        self._eye = eye

    def start_thread(self) -> threading.Thread:
        """Start the thread."""
        return threads.start(self.run, f"camera-{self._eye}")


PATTERN, FILE = "pattern", "file:"


@dataclass(frozen=True)
class CameraChoice:
    """The source of one eye."""

    eye: str
    source: str
    """`pattern`, `file:PATH`, or a USB camera: its path on Linux, elsewhere its number"""

    def build(self) -> FrameSource:
        """Create the source without opening it."""
        if self.source == PATTERN:
            return Pattern(self.eye)
        if self.source.startswith(FILE):
            return PictureFiles(Path(self.source.removeprefix(FILE)))
        # Each library is an extra for one operating system, so only the one that is needed is imported.
        if on_linux():
            from hw_node.cameras import v4l2  # noqa: PLC0415

            return v4l2.V4l2Camera(Path(self.source))
        from hw_node.cameras import opencv  # noqa: PLC0415

        return opencv.OpenCvCamera(int(self.source), opencv.library())

    def sensor(self, node: Node) -> CameraSensor:
        """Create the sensor of this eye."""
        return CameraSensor(node, self.eye, self.build())

    @property
    def device(self) -> Path | int | None:
        """The USB camera, however its path or number is written; None: it is no USB camera."""
        if self.source == PATTERN or self.source.startswith(FILE):
            return None
        return Path(self.source).resolve() if on_linux() else int(self.source)

    def mistake(self) -> str:
        """Return why the source can never work, else an empty text; a missing camera may be plugged in later."""
        source = self.source
        if source == PATTERN or source.startswith(FILE):
            return self.build().trouble().rstrip(".")
        if on_linux() and not source.startswith("/"):
            return f"{quoted(source)} is not a path that begins with /. Choose {examples()}"
        if not on_linux() and not (source.isascii() and source.isdigit()):
            return f"{quoted(source)} is not a number, and USB cameras have numbers on this system. Choose {examples()}"
        module, package = ("linuxpy", "linuxpy") if on_linux() else ("cv2", "opencv-python-headless")
        if importlib.util.find_spec(module) is None:
            return f'USB cameras need {package}: pip install ".[cameras]" in the folder of BEATRIX'
        return ""


TEST_EYES: Final = tuple(CameraChoice(eye, PATTERN).sensor for eye in names.EYES)
"""the sensors of two eyes that show a test picture"""


def on_linux() -> bool:
    """Return whether this is Linux, where USB cameras have paths and linuxpy reads them.

    On other systems they have numbers, and OpenCV reads them.
    """
    return sys.platform.startswith("linux")


def examples() -> str:
    """Return examples of values of --camera on this system."""
    usb = "/dev/v4l/by-path/…" if on_linux() else "0"
    return (
        f"left={usb} (a USB camera), left=pattern (a test picture), or left=file:PATH (pictures or a video)"
    )


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
            how = (
                "`ls /dev/v4l/by-path` lists all cameras"
                if on_linux()
                else "The numbers of cameras begin at 0"
            )
            raise wrong(word, f"the other eye has this camera already. {how}")
        found[eye] = choice
    return list(found.values())


def wrong(word: str, what: str) -> WrongUsage:
    """Return the error for an invalid value of --camera."""
    return WrongUsage(Reason.BAD_VALUE, f"camera {word}: {what}.")
