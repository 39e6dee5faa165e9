"""Make docs/images/recording-*.png and docs/images/film.png.

They show a lesson with a simulation and a virtual robot, recorded and drawn without a screen.

Usage: .venv/bin/python tools/recording_pictures.py [DIR]
"""

from __future__ import annotations

import contextlib
import io
import socket
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from bench_node import ROOT, Served
from PIL import Image
from viewer_pictures import FILES, pictures

from beatrix_zenoh import Interrupted, Refused, Twin
from beatrix_zenoh.recording.film import side_by_side
from beatrix_zenoh.recording.verbs.export import opened

NAME = "bea1"
LARGEST = 300_000
"""Largest size (bytes) of a picture in the repository."""


def lesson(endpoint: str) -> tuple[float, float]:
    """Make motions with a lead, a refused motion and a stopped one; return the times (s since 1970) of the pictures."""
    with Twin(NAME, connect=endpoint, who="ana") as twin:
        twin.enable()
        twin.calibrate()
        time.sleep(1.0)
        motion = twin.preview(yaw=35, pitch=12).commit(lead_s=1.5, wait=False)
        time.sleep(2.0)
        lead = time.time()  # the hardware has begun, the simulation has arrived
        motion.result()
        with contextlib.suppress(Refused):
            twin.sim.look(pitch=60)
        for yaw, pitch, roll in ((-25, -8, 10), (10, 15, -10), (0, 0, 0)):
            twin.preview(yaw=yaw, pitch=pitch, roll=roll).commit(lead_s=0.0)
        stopped = twin.hw.look(yaw=-40, wait=False)
        time.sleep(0.6)
        twin.hw.stop()
        with contextlib.suppress(Interrupted):
            stopped.wait()
        time.sleep(1.0)
        return lead, time.time() - 0.3


def small(png: bytes) -> bytes:
    """Return the picture with so few colours, but at least 16, that it is at most LARGEST bytes long."""
    picture, smaller, colours = Image.open(io.BytesIO(png)).convert("RGB"), png, 512
    while len(smaller) > LARGEST and colours > 16:
        colours //= 2
        found = io.BytesIO()
        picture.quantize(colours).save(found, "PNG", optimize=True)
        smaller = found.getvalue()
    return smaller


def film_frame(path: Path, moment_s: float) -> bytes:
    """Return the frame of a recording's film at a moment (s since 1970), as PNG."""
    table = opened([path], 0.0, None, ())
    frames = side_by_side(table, NAME)
    frame = next(frame for frame in frames if frame.time_ns >= moment_s * 1e9)
    picture = io.BytesIO()
    Image.fromarray(frame.pixels).quantize(256, dither=Image.Dither.NONE).save(picture, "PNG", optimize=True)
    return picture.getvalue()


def main() -> None:
    """Record a lesson, draw the pictures, and write the files."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/images"
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    with TemporaryDirectory() as made:
        path = Path(made) / "lesson.rrd"
        where = ("--name", NAME, "--connect", endpoint)
        served = [
            Served("beatrix_zenoh.cli", "router", "--listen", endpoint),
            Served("sim_node", *where),
            Served("hw_node", *where, "--port", "virtual:"),
            Served("beatrix_zenoh.cli", "record", str(path), "--connect", endpoint),
        ]
        time.sleep(2.0)
        lead, end = lesson(endpoint)
        for process in reversed(served):
            process.end()
        drawn = pictures(path, [(0, lead), (1, lead), (2, end), (3, end)])
        (folder / "film.png").write_bytes(film_frame(path, lead))
    for name, png in zip(FILES, drawn, strict=True):
        (folder / f"recording-{name}.png").write_bytes(small(png))


if __name__ == "__main__":
    main()
