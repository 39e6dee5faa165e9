"""Pictures that a simulation has drawn."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt
import simplejpeg

from beatrix_zenoh.client import CameraImage
from beatrix_zenoh.client.subscription import Subscription
from sim_node.renderer import HEIGHT, WIDTH

FIRST_S = 60.0
"""Longest wait (s) for the first picture, for which the node tests and starts a renderer."""


def fresh(images: Subscription[CameraImage]) -> npt.NDArray[np.uint8]:
    """Return a picture that was taken after this call; shape (height, width, 3)."""
    now_ns = time.monotonic_ns()
    while (image := images.next(FIRST_S)).t_mono_ns <= now_ns:
        pass
    assert (image.width, image.height) == (WIDTH, HEIGHT)
    picture: npt.NDArray[np.uint8] = simplejpeg.decode_jpeg(image.jpeg)
    return picture
