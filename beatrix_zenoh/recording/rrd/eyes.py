"""Read the pictures of a robot's eyes from a recording."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Sequence
from pathlib import Path

from rerun.chunk import RrdReader
from rerun.error_utils import RerunWarning

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract.names import EYES
from beatrix_zenoh.recording.film import EyePictures, Picture
from beatrix_zenoh.recording.rows import of_robot
from beatrix_zenoh.recording.rrd.read import TIME

BLOB = "EncodedImage:blob"


def read_eyes(paths: Sequence[Path], places: Sequence[Place], first_ns: int, last_ns: int) -> EyePictures:
    """Return the pictures of all eyes of these robots between two times, in the order of time.

    The files must be readable, which `read` checks.
    """
    entities = {"/" + of_robot(place, "camera", eye): (*place, eye) for place in places for eye in EYES}
    found: EyePictures = {}
    for path in paths:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RerunWarning)  # a killed recorder leaves a file without its end
            chunks = RrdReader(path).stream().filter(content=list(entities))
        for chunk in chunks:
            if chunk.is_static or TIME not in chunk.timeline_names:
                continue
            batch = chunk.to_record_batch()
            if BLOB not in batch.schema.names:
                continue
            times = batch.column(TIME).cast("int64").to_pylist()
            blobs = batch.column(BLOB).flatten()
            ends, flat = blobs.offsets.to_pylist(), blobs.values.to_numpy()
            found.setdefault(entities[chunk.entity_path], []).extend(
                Picture(time_ns, flat[begin:end].tobytes())
                for time_ns, (begin, end) in zip(times, itertools.pairwise(ends), strict=True)
                if first_ns <= time_ns <= last_ns
            )
    for pictures in found.values():
        pictures.sort(key=lambda picture: picture.time_ns)
    return {key: pictures for key, pictures in found.items() if pictures}
