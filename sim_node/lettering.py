"""Letters for signs in the scene and for the badge on pictures that were not drawn with OpenGL."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.lettering import ROWS, points
from sim_node.shapes import Shape

Cells = npt.NDArray[np.bool_]
"""Rows from the top, shape (rows, columns): True is ink."""


def cells(text: str) -> Cells:
    """Return the text as cells, with an empty column between letters; raises KeyError for a letter without a glyph."""
    gap = np.zeros((ROWS, 1), np.bool_)
    letters = [part for letter in text for part in (np.array(points(letter)), gap)]
    return np.concatenate(letters[:-1], axis=1)


def plate(ink: Cells, cell: float, depth: float) -> Shape:
    """Return the ink as blocks of `cell` x `cell` x `depth` (m) in the y-z plane, legible from -x, centred at 0."""
    rows, columns = ink.shape
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    triangles = np.array([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))], dtype=np.int32)
    vertices, faces = [], []
    for count, (row, column) in enumerate(np.argwhere(ink).tolist()):
        # Seen from -x, y grows to the left.
        middle = np.array((0.0, (columns - 1) / 2 - column, (rows - 1) / 2 - row)) * cell
        vertices.append(corners * (depth, cell, cell) + middle)
        faces.append(triangles + 8 * count)
    return Shape(np.concatenate(vertices), np.concatenate(faces))
