"""Pictures without a camera, the structure of JPEG files, and the values of --camera."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import simplejpeg

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.contract._generated.messages import FrameHeader
from beatrix_zenoh.contract.errors import WrongUsage
from hw_node.cameras import camera, jpeg
from hw_node.cameras.stand_ins import Pattern, PictureFiles, number_and_time


def picture(level: int, width: int = 32, height: int = 16) -> bytes:
    """Return a grey JPEG picture, a different one for each level."""
    encoded: bytes = simplejpeg.encode_jpeg(np.full((height, width, 3), level, np.uint8), colorspace="RGB")
    return encoded


def shown(files: PictureFiles, count: int) -> list[bytes]:
    files.open()
    frames = [files.next(1.0) for _ in range(count)]
    files.close()
    return [frame.payload for frame in frames if frame is not None]


# -- the test picture ------------------------------------------------------------------------------


def test_programs_can_read_number_and_time_of_the_test_picture() -> None:
    pattern = Pattern("left")
    pattern.open()
    for wanted in (1, 2, 3):
        frame = pattern.next(1.0)
        assert frame is not None
        number, t_ms = number_and_time(simplejpeg.decode_jpeg(frame.payload))
        assert (number, t_ms) == (wanted, frame.header.t_mono_ns // 1_000_000 % 2**32)
        assert isinstance(frame.header, FrameHeader)
        assert simplejpeg.decode_jpeg_header(frame.payload)[:2] == (frame.header.height, frame.header.width)


# -- JPEG ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "damaged",
    [b"", b"no picture", jpeg.SOI, picture(1)[:30], jpeg.SOI + b"\xff" * 9, picture(1)[:4] + bytes(99)],
)
def test_an_invalid_picture_raises_value_error(damaged: bytes) -> None:
    with pytest.raises(ValueError, match=r"it is not a JPEG picture|damaged"):
        jpeg.complete(damaged)


# -- files -----------------------------------------------------------------------------------------


def test_the_pictures_of_a_folder_are_repeated_in_order(tmp_path: Path) -> None:
    pictures = [picture(level) for level in (50, 60)]
    (tmp_path / "b.jpeg").write_bytes(pictures[1])
    (tmp_path / "a.JPG").write_bytes(pictures[0])
    (tmp_path / "notes.txt").write_text("not shown")
    assert shown(PictureFiles(tmp_path), 3) == [*pictures, pictures[0]]


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("empty.jpg", b"", "it is not a JPEG picture"),
        ("video.avi", b"RIFF another codec", "it is not a JPEG picture"),
        ("cut.jpeg", picture(3)[:20], "damaged"),
    ],
)
def test_the_error_for_an_unusable_file_contains_the_cause(
    tmp_path: Path, name: str, content: bytes, why: str
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    files = PictureFiles(path)
    with pytest.raises(NoAnswer, match=why) as refused:
        shown(files, 1)
    files.close()
    assert str(path) in refused.value.message


# -- the values of --camera ------------------------------------------------------------------------


def test_each_eye_gets_its_source(tmp_path: Path) -> None:
    found = camera.choices([f"right=file:{tmp_path}", "left=pattern"])
    assert {one.eye: type(one.build()).__name__ for one in found} == {
        "right": "PictureFiles",
        "left": "Pattern",
    }


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["pattern"], "give an eye"),
        (["middle=pattern"], "give an eye"),
        (["left="], "give an eye"),
        (["left=pattern", "left=pattern"], "has a camera already"),
        (["left=patern"], "neither a path that begins with / nor a number"),
        (["left=file:/nowhere/at/all"], "/nowhere/at/all does not exist"),
    ],
)
def test_invalid_values_are_refused(words: list[str], why: str) -> None:
    with pytest.raises(WrongUsage, match=why) as refused:
        camera.choices(words)
    assert refused.value.message.startswith(f"camera {words[-1]}: ")


def test_one_camera_is_refused_for_both_eyes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: True)
    (tmp_path / "video0").touch()
    (tmp_path / "by-path").symlink_to(tmp_path / "video0")
    with pytest.raises(WrongUsage, match="the other eye has this camera already"):
        camera.choices([f"left={tmp_path}/video0", f"right={tmp_path}/by-path"])


def test_usb_cameras_are_refused_without_their_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(WrongUsage, match="opencv-python-headless: beatrix install cameras"):
        camera.choices(["left=/dev/video0"])


def without_tables(whole: bytes) -> bytes:
    head = list(jpeg.segments(whole))
    kept = [whole[one.begin : one.end] for one in head if one.marker != jpeg.DHT]
    return b"".join([jpeg.SOI, *kept, whole[head[-1].end :]])


def test_only_missing_tables_are_added() -> None:
    whole = picture(100)
    assert jpeg.complete(whole) is whole
    completed = jpeg.complete(without_tables(whole))
    assert np.array_equal(simplejpeg.decode_jpeg(completed), simplejpeg.decode_jpeg(whole))
