"""A font of 5 x 7 points, for test pictures and for the badge on pictures that were not drawn with OpenGL."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

COLUMNS: Final = 5
ROWS: Final = 7
_GLYPHS: Final = {
    " ": "00 00 00 00 00 00 00",
    "0": "0e 11 11 11 11 11 0e",
    "1": "04 0c 04 04 04 04 0e",
    "2": "0e 11 01 02 04 08 1f",
    "3": "1f 02 04 02 01 11 0e",
    "4": "02 06 0a 12 1f 02 02",
    "5": "1f 10 1e 01 01 11 0e",
    "6": "06 08 10 1e 11 11 0e",
    "7": "1f 01 02 04 08 08 08",
    "8": "0e 11 11 0e 11 11 0e",
    "9": "0e 11 11 0f 01 02 0c",
    "-": "00 00 00 1f 00 00 00",
    ".": "00 00 00 00 00 0c 0c",
    ":": "00 04 04 00 04 04 00",
    "E": "1f 10 10 1e 10 10 1f",
    "F": "1f 10 10 1e 10 10 10",
    "G": "0e 11 10 17 11 11 0f",
    "H": "11 11 11 1f 11 11 11",
    "I": "0e 04 04 04 04 04 0e",
    "L": "10 10 10 10 10 10 1f",
    "N": "11 19 15 15 15 13 11",
    "O": "0e 11 11 11 11 11 0e",
    "P": "1e 11 11 1e 10 10 10",
    "R": "1e 11 11 1e 14 12 11",
    "T": "1f 04 04 04 04 04 04",
}
"""The available characters: one byte (hexadecimal) for each row from the top, whose bit 4 is the left column."""


def cells(text: str) -> npt.NDArray[np.bool_]:
    """Return the text as cells, rows from the top, True for ink; each letter ends with an empty column.

    Raises KeyError for an unknown letter.
    """
    rows = ([int(row, 16) << 1 for row in _GLYPHS[letter].split()] for letter in text)
    bits = np.arange(COLUMNS, -1, -1)
    return np.concatenate(
        [(np.array(letter)[:, None] >> bits & 1).astype(np.bool_) for letter in rows], axis=1
    )
