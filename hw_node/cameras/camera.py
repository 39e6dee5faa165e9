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
OTHERS: Final = "left=pattern (a test picture), or left=file:PATH (pictures or a video)"
LIBRARIES: Final = {"linuxpy": "linuxpy", "cv2": "opencv-python-headless"}
"""Modules that read USB cameras, and the packages that contain them."""


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


TEST_EYES: Final = tuple(CameraChoice(eye, PATTERN).sensor for eye in names.EYES)
"""the sensors of two eyes that show a test picture"""


def on_linux() -> bool:
    """Return whether this is Linux, where USB cameras have paths and linuxpy reads them.

    On other systems they have numbers, and OpenCV reads them.
    """
    return sys.platform.startswith("linux")


def examples() -> str:
    """Return examples of values of --camera on this system."""
    return f"left={'/dev/v4l/by-path/…' if on_linux() else '0'} (a USB camera), {OTHERS}"


def choices(words: Sequence[str]) -> list[CameraChoice]:
    """Convert words of the form `EYE=SOURCE` to checked choices.

    Raises:
        WrongUsage: BAD_VALUE, with the mistake and the allowed values.
    """
    found: dict[str, CameraChoice] = {}
    for word in words:
        eye, equals, source = word.partition("=")
        if eye not in names.EYES or not equals or not source:
            raise wrong(word, f"give an eye, left or right, and its source: {examples()}")
        if eye in found:
            raise wrong(word, f"the {eye} eye has a camera already. Name each eye only once")
        found[eye] = CameraChoice(eye, source)
        check(word, found[eye], [one for one in found.values() if one.eye != eye])
    return list(found.values())


def check(word: str, choice: CameraChoice, others: Sequence[CameraChoice]) -> None:
    """Raise WrongUsage for a source that can never work; a camera that is missing now may be plugged in later."""
    source = choice.source
    if source == PATTERN:
        return
    if source.startswith(FILE):
        trouble = PictureFiles(Path(source.removeprefix(FILE))).trouble()
        if trouble:
            raise wrong(word, trouble.rstrip("."))
        return
    check_usb(word, source)
    if any(same(other.source, source) for other in others):
        how = "`ls /dev/v4l/by-path` lists all cameras" if on_linux() else "The numbers of cameras begin at 0"
        raise wrong(word, f"the other eye has this camera already. {how}")


def check_usb(word: str, source: str) -> None:
    """Raise WrongUsage if the name is invalid on this system, or the library for USB cameras is missing."""
    if on_linux() and not source.startswith("/"):
        raise wrong(word, f"{quoted(source)} is not a path that begins with /. Choose {examples()}")
    if not on_linux() and not (source.isascii() and source.isdigit()):
        raise wrong(
            word,
            f"{quoted(source)} is not a number, and USB cameras have numbers on this system. Choose {examples()}",
        )
    module = "linuxpy" if on_linux() else "cv2"
    if importlib.util.find_spec(module) is None:
        raise wrong(
            word,
            f'USB cameras need {LIBRARIES[module]}: pip install ".[cameras]" in the folder of BEATRIX',
        )


def same(one: str, other: str) -> bool:
    """Return whether two texts name the same USB camera: paths or numbers that may be written differently."""
    if on_linux():
        return Path(one).resolve() == Path(other).resolve()
    return one.isdigit() and int(one) == int(other)


def wrong(word: str, what: str) -> WrongUsage:
    """Return the error for an invalid value of --camera."""
    return WrongUsage(Reason.BAD_VALUE, f"camera {word}: {what}.")
