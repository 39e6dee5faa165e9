"""Films as files: pictures with their times, as H.264 in MP4."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Final, NamedTuple

import av
from av.video.reformatter import ColorRange, Colorspace
from av.video.stream import VideoStream

from beatrix_zenoh.body.portrait import Pixels

TICKS: Final = 90_000
"""Ticks of a film's time in a second, the usual number for H.264."""
RATE: Final = 25
"""Frames a second that the file announces; the time of each frame is its own."""
OPTIONS: Final = {"crf": "20", "preset": "veryfast"}
"""Quality and speed of libx264: a film of two robots is not distinguishable from its frames."""


class FilmFrame(NamedTuple):
    """A picture of a film, and its time (ns since 1970)."""

    time_ns: int
    pixels: Pixels


def write_video(path: Path, frames: Iterable[FilmFrame]) -> int:
    """Write a film with the times of its frames, and return their number; without frames there is no file.

    Raises:
        OSError: the file cannot be written.
    """
    waiting = iter(frames)
    first = next(waiting, None)
    if first is None:
        return 0
    count = 0
    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream = new_stream(container, first)
        for count, frame in enumerate(itertools.chain([first], waiting), start=1):  # noqa: B007
            picture = av.VideoFrame.from_ndarray(frame.pixels, format="rgb24")
            picture.time_base = Fraction(1, TICKS)
            picture.pts = round((frame.time_ns - first.time_ns) * TICKS / 1e9)
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))
    return count


def new_stream(container: av.container.OutputContainer, frame: FilmFrame) -> VideoStream:
    """Add the stream of pictures to a file, in the size of the first frame."""
    stream = container.add_stream("libx264", rate=RATE, options=OPTIONS)
    stream.height, stream.width = frame.pixels.shape[:2]
    stream.pix_fmt = "yuv420p"  # browsers show no other one
    # Players guess the colours of a large picture otherwise, and wrong ones.
    stream.codec_context.colorspace = Colorspace.ITU601
    stream.codec_context.color_range = ColorRange.MPEG
    stream.codec_context.time_base = Fraction(1, TICKS)
    stream.time_base = Fraction(1, TICKS)
    return stream
