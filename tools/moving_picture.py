"""Make docs/images/twin.gif, in which a simulation leads and a virtual robot follows, from their published positions.

Usage: .venv/bin/python tools/moving_picture.py [FILE]
"""

from __future__ import annotations

import math
import socket
import sys
import time
from functools import cache
from pathlib import Path
from typing import Final

from bench_node import ROOT, Served
from PIL import Image, ImageDraw, ImageFont
from studio import CAMERA, studio

from beatrix_zenoh import Twin
from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.motion.gear import Arms
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.plant import Plant

NAME: Final = "bea1"
POSES: Final = ((-45.0, -4.0, -10.0), (10.0, 12.0, 10.0), (0.0, 0.0, 0.0))
"""Yaw, pitch and roll in degrees, one after the other."""
LEAD_S: Final = 0.7
SPEED_DEG_S: Final = 80.0
REST_S: Final = 0.4
FRAME_S: Final = 0.08
WIDTH: Final = 320
"""Width of the picture of one robot (px)."""
HEIGHT: Final = 340
COLOURS: Final = 96
STRIP: Final = 28
"""Height of the titles below the robots (px)."""
TITLES: Final = ("simulation", "virtual robot")

Moment = tuple[ArmAngles, ArmAngles]
"""Arms of the simulation and of the hardware, degrees."""


def movement(endpoint: str) -> list[Moment]:
    """Make both robots take the poses with a lead; return their arm angles, one entry per frame."""
    moments: list[Moment] = []
    began = time.monotonic()

    def follow(twin: Twin) -> None:
        time.sleep(max(0.0, began + FRAME_S * len(moments) - time.monotonic()))
        both = twin.positions()
        moments.append((both.sim.arms, both.hw.arms))

    with Twin(NAME, connect=endpoint) as twin:
        twin.make_ready()
        twin.preview().commit(lead_s=0.0)
        began = time.monotonic()
        for yaw, pitch, roll in POSES:
            motion = twin.preview(yaw=yaw, pitch=pitch, roll=roll, speed=SPEED_DEG_S).commit(
                lead_s=LEAD_S, wait=False
            )
            while not motion.done():
                follow(twin)
            for _ in range(round(REST_S / FRAME_S)):
                follow(twin)
    return moments


def frames(moments: list[Moment]) -> list[Image.Image]:
    """Draw both robots side by side at each moment; needs OpenGL."""
    plant = Plant()
    painter = GlPainter(studio(), 2 * WIDTH, 2 * HEIGHT, name=gl.backend() or "egl", shadows=True, samples=4)

    @cache
    def drawn(arms: Arms) -> Image.Image:
        plant.place(arms)
        painter.pose(plant.posture())
        return Image.fromarray(painter.paint(CAMERA)).reduce(2)

    images = [titled() for _ in moments]
    for image, moment in zip(images, moments, strict=True):
        for index, arms in enumerate(moment):
            # Rounded, so that a robot at rest is drawn only once.
            x, y, z = (round(math.radians(angle), 3) for angle in arms)
            image.paste(drawn((x, y, z)), (index * WIDTH, 0))
    painter.close()
    return images


def titled() -> Image.Image:
    """Return an image with the titles below the places of both robots."""
    image = Image.new("RGB", (2 * WIDTH, HEIGHT + STRIP), (255, 255, 255))
    for index, title in enumerate(TITLES):
        place = ((index + 0.5) * WIDTH, HEIGHT + STRIP / 2)
        ImageDraw.Draw(image).text(
            place, title, fill=(40, 44, 52), font=ImageFont.load_default(18), anchor="mm"
        )
    return image


def reduced(images: list[Image.Image]) -> list[Image.Image]:
    """Return the images with one palette, computed from the middle (head and neck) of about six of them."""
    some = images[:: len(images) // 6]
    sample = Image.new("RGB", (WIDTH // 2, len(some) * HEIGHT))
    for index, image in enumerate(some):
        sample.paste(image.crop((WIDTH // 4, 0, 3 * WIDTH // 4, HEIGHT)), (0, index * HEIGHT))
    palette = sample.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=5)
    return [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]


def main() -> None:
    """Record the motions, draw the pictures, and write the file."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/images/twin.gif"
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    where = ("--name", NAME, "--connect", endpoint)
    served = [
        Served("beatrix_zenoh.cli", "router", "--listen", endpoint),
        Served("sim_node", *where),
        Served("hw_node", *where, "--port", "virtual:"),
    ]
    try:
        moments = movement(endpoint)
    finally:
        for process in reversed(served):
            process.end()
    first, *rest = images = reduced(frames(moments))
    first.save(
        path, save_all=True, append_images=rest, duration=round(FRAME_S * 1000), loop=0, optimize=False
    )
    print(path, len(images), "frames", path.stat().st_size, "bytes")


if __name__ == "__main__":
    main()
