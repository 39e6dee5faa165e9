"""The picture of the demo: where both robots were in each part of the movement."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.portrait import PoseRenderer, write
from beatrix_zenoh.body.scene import Viewpoint
from beatrix_zenoh.client.log import Log
from beatrix_zenoh.files import new_file

SIZE: Final = (300, 320)
"""Of one robot (px)."""
VIEW: Final = Viewpoint(azimuth=-14.0, elevation=10.0, zoom=0.84, height=-0.001)
"""Nearly from the front, with the whole robot in every pose."""
TURN_S: Final = 0.5
"""Time after which the head has left the pose of the part before."""


def write_picture(path: Path, logs: Mapping[str, Log], parts: Mapping[str, float]) -> None:
    """Write each robot, a row each, where its head was turned furthest in each part.

    Args:
        path: of the picture, a PNG file.
        logs: by title of the robot.
        parts: when each part of the movement began (s in the logs), in this order.

    Raises:
        Refused: BAD_VALUE, the file cannot be written.
    """
    robot = PoseRenderer(Figure(), *SIZE, VIEW)
    image = Image.new("RGB", (SIZE[0] * len(parts), SIZE[1] * len(logs)))
    for row, (title, log) in enumerate(logs.items()):
        arms = np.stack((log.short, log.middle, log.long), axis=1)
        head = np.stack((log.yaw, log.pitch, log.roll), axis=1)
        ends = [*list(parts.values())[1:], np.inf]
        for column, ((part, begin), end) in enumerate(zip(parts.items(), ends, strict=True)):
            turned = np.where((log.t > begin + TURN_S) & (log.t < end), np.abs(head).max(axis=1), -1.0)
            moment = int(turned.argmax())
            at = SIZE[0] * column, SIZE[1] * row
            image.paste(Image.fromarray(robot.picture(arms[moment], head[moment])), at)
            write(image, (at[0] + 12, at[1] + 10), f"{title}: {part}", size=15)
    with new_file(path) as unfinished:
        image.save(unfinished, format="PNG")
