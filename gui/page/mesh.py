"""The robot as a file that pages draw: `/head.json`, in tenths of a millimetre."""

from __future__ import annotations

import gzip
from functools import cache
from typing import Final

import msgspec

from beatrix_zenoh.body import scene
from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.surface import Mesh
from gui.page.handlers import Guarded

TENTHS: Final = 1e4
"""Units of the points of the file in a metre."""


def _body(mesh: Mesh) -> dict[str, object]:
    """Return path, points, and for each solid its colour and the four corners of its faces, as flat lists."""
    of_solid = mesh.order[mesh.faces[:, 0]]
    solids = []
    for part in sorted({*of_solid.tolist()}):
        faces = mesh.faces[of_solid == part]
        solids.append([mesh.colours[faces[0, 0]].tolist(), faces.ravel().tolist()])
    return {
        "path": mesh.path,
        "points": (mesh.points.ravel() * TENTHS).round().astype(int).tolist(),
        "solids": solids,
    }


@cache
def packed() -> bytes:
    """Return the file, compressed; made once."""
    figure = Figure()
    content = {
        "tenths": TENTHS,
        "bodies": [_body(mesh) for mesh in meshes(figure)],
        "rods": [{"elbow": chain.elbow, "mount": chain.mount} for chain in figure.chains],
        "skull": scene.SKULL,
        "nose": scene.NOSE,
        "ears": scene.EARS,
        "crown": scene.CROWN,
    }
    return gzip.compress(msgspec.json.encode(content), mtime=0)


class HeadMesh(Guarded):
    """The file of the robot; a browser keeps it, and only asks whether it has changed."""

    def get(self) -> None:
        """Send the file, or status 304 to a browser that has it."""
        self.set_header("Cache-Control", "no-cache")
        self.set_header("Content-Type", "application/json")
        self.set_header("Content-Encoding", "gzip")  # as all browsers can read it
        self.write(packed())
