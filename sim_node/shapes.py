"""Points and vectors of the simulation, as arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]
Point = tuple[float, float, float]
"""x forward, y left, z up (m), from the neck centre."""
