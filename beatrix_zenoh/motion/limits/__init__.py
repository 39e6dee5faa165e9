"""Limits of the neck: every motion is checked over its whole path before it is accepted."""

from __future__ import annotations

from beatrix_zenoh.motion.limits.limits import SLOWEST_LIMIT_DEG, Limits, with_alternative
from beatrix_zenoh.motion.limits.path_check import TILT_KNOWN_BEYOND, known_tilt

__all__ = ["SLOWEST_LIMIT_DEG", "TILT_KNOWN_BEYOND", "Limits", "known_tilt", "with_alternative"]
